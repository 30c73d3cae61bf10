/* Any bytes as a mesh. */
#include "tests/fuzz-import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	fuzz_import(&import_mesh, data, size);
	return 0;
}
