#ifndef TESTS_SUPPORT_H
#define TESTS_SUPPORT_H
/* What tests share. */

/* The path of a file beside the checkout that is not part of it ("vectors/sick_sEA_on.txt"):
 * captured telegrams and real scans. It is looked for in $PLEINAIR_SHARED, else in ../shared from
 * $PLEINAIR_SOURCE or here. NULL where it is not, so that a test can say g_test_skip; valid for the
 * life of the program. */
const char *shared_path(const char *relative);

#endif
