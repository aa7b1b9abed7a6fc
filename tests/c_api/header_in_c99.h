#ifndef HEADER_IN_C99_H
#define HEADER_IN_C99_H

#ifdef __cplusplus
extern "C" {
#endif

int c99_version_is_served(void);
/* 0, or the number of the call that went wrong. */
int c99_connects_without_a_daemon(void);

#ifdef __cplusplus
}
#endif

#endif
