/* Any bytes as a table of points in ASCII. */
#include "tests/fuzz-import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	fuzz_import(&import_ascii, data, size);
	return 0;
}
