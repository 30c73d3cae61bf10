/* Any bytes whatsoever to the decoder of LDRobot's lidars. Sums are mended where a packet begins, or
 * nearly none would come past them. */
#include "tests/fuzz-decoder.h"
#include "tests/ld-made.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autofree uint8_t *mended = g_memdup2(data, size);
	for (size_t at = 0; at + 47 <= size; at++)
		if (mended[at] == 0x54 && mended[at + 1] == 0x2c && !(mended[at + 45] & 0x80)) {
			mended[at + 46] = made_sum(mended + at, 46);
			at += 46;
		}
	fuzz_decoder("ld", "", mended, size);
	return 0;
}
