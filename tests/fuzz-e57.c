/* Any bytes as E57. What random bytes would hardly ever come past, the checksums of pages, is made right before. */
#include "firmware-io/crc32c.h"
#include "process/e57.h"
#include "tests/fuzz-import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	fuzz_import(&import_e57, data, size);
	g_autofree uint8_t *bytes = g_memdup2(data, size);
	for (size_t page = 0; page + E57_PAGE_BYTES <= size; page += E57_PAGE_BYTES) {
		uint32_t sum = GUINT32_TO_BE(crc32c(0, bytes + page, E57_PAGE_PAYLOAD));
		memcpy(bytes + page + E57_PAGE_PAYLOAD, &sum, sizeof sum);
	}
	fuzz_import(&import_e57, bytes, size);
	return 0;
}
