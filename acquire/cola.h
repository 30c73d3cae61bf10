#ifndef ACQUIRE_COLA_H
#define ACQUIRE_COLA_H
/* CoLa-A, the protocol of SICK: telegrams of ASCII between STX and ETX, no length, no sum. */

#define COLA_STX                0x02
#define COLA_ETX                0x03
#define COLA_TELEGRAM_BYTES_MAX (1 << 20) /* between STX and ETX; a TiM sends some 7 KB at most */

/* What sFA's number (lidar_reply.status) means, for messages to people; "unknown error" where the
 * manual has none. */
const char *cola_error_text(const char *status);

#endif
