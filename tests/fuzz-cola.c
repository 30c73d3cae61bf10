/* Any bytes whatsoever to the CoLa-A decoder; the start leaves it inside a telegram. */
#include "tests/fuzz-decoder.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	fuzz_decoder("cola",
		"\x02sSN LMDscandata 1 1 1A2B3C4 0 0 7 8 1000 2000 0 0 1 0 0 5DC 36 0 ", data,
		size);
	return 0;
}
