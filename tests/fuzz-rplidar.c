/* Any bytes whatsoever to the RPLIDAR decoder. The first byte says with which stream it begins. */
#include "acquire/rplidar-frames.h"
#include "tests/fuzz-decoder.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Sums are mended where a capsule seems to begin, or nearly none would come past them. */
static void mend(uint8_t *bytes, size_t size, size_t frame)
{
	for (size_t at = 0; at + frame <= size; at++) {
		uint8_t sum = 0;
		if (bytes[at] >> 4 != 0xa || bytes[at + 1] >> 4 != 5 || bytes[at + 2] == 0xff)
			continue;
		for (size_t i = 2; i < frame; i++)
			sum ^= bytes[at + i];
		bytes[at] = 0xa0 | (sum & 15);
		bytes[at + 1] = 0x50 | sum >> 4;
		at += frame - 1;
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (size < 2)
		return 0;
	enum rplidar_format format = data[0] % RPLIDAR_FORMATS;
	size_t frame = rplidar_frame_bytes(format), descriptor = RPLIDAR_DESCRIPTOR_BYTES;
	/* The descriptor of the stream, and what follows it; the second byte says how long pieces are. */
	g_autofree uint8_t *bytes = g_malloc(descriptor + size - 2);
	uint8_t begin[] = { 0xa5, 0x5a, (uint8_t)frame, (uint8_t)(frame >> 8), 0, 0x40,
		rplidar_answer_type(format) };
	memcpy(bytes, begin, descriptor);
	memcpy(bytes + descriptor, data + 2, size - 2);
	if (format != RPLIDAR_STANDARD && format != RPLIDAR_HQ)
		mend(bytes + descriptor, size - 2, frame);
	struct collected *whole = collected_new(), *cut = collected_new();
	decoder *a = collected_decoder(whole, "rplidar"), *b = collected_decoder(cut, "rplidar");
	fuzz_feed(a, bytes, descriptor + size - 2, NULL, 0);
	fuzz_feed(b, bytes, descriptor + size - 2, data + 1, 1);
	g_assert_cmpuint(whole->scanlines, ==, cut->scanlines);
	g_assert_cmpuint(whole->replies, ==, cut->replies);
	g_assert_cmphex(whole->hash, ==, cut->hash);
	g_assert_cmpmem(decoder_get_counts(a), sizeof(struct decoder_counts), decoder_get_counts(b),
		sizeof(struct decoder_counts));
	decoder_free(a);
	decoder_free(b);
	collected_free(whole);
	collected_free(cut);
	return 0;
}
