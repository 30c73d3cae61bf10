/* Any bytes as PCD. */
#include "tests/fuzz-import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	fuzz_import(&import_pcd, data, size);
	return 0;
}
