#include "main_view/client/c_api/sightline.h"

extern "C" uint32_t sl_version(void) {
  return SL_API_VERSION;
}

#define SL_TEXT_OF(number) #number
#define SL_TEXT(number) SL_TEXT_OF(number)

extern "C" const char* sl_version_text(void) {
  return SL_TEXT(SL_VERSION_MAJOR) "." SL_TEXT(SL_VERSION_MINOR) " (sightline " SIGHTLINE_VERSION ")";
}

extern "C" const char* sl_status_text(sl_status status) {
  switch (status) {
    case SL_OK:
      return "done";
    case SL_PENDING:
      return "not yet: ask again";
    case SL_TIMEOUT:
      return "the time to wait is over; what is known without the answer is in force";
    case SL_ERROR_ARGUMENT:
      return "a null pointer, or a value that is none of those allowed";
    case SL_ERROR_HANDLE:
      return "the handle is null, closed or was never given out";
    case SL_ERROR_STRUCT_SIZE:
      return "struct_size is too small, or fields this library does not know are set";
    case SL_ERROR_VERSION:
      return "the program was built for a newer or incompatible libsightline";
    case SL_ERROR_BUSY:
      return "another thread is in a call on this handle";
    case SL_ERROR_ORDER:
      return "the call came too early or too late";
    case SL_ERROR_RANGE:
      return "an id, a view or a count that does not exist";
    case SL_ERROR_NOT_FINITE:
      return "a number is not finite, or beyond 10^12";
    case SL_ERROR_MATRIX:
      return "a matrix has no inverse, or a view is not rigid, mirrored or uniformly scaled";
    case SL_ERROR_FULL:
      return "no spare object is left, or a limit is reached";
    case SL_ERROR_MEMORY:
      return "out of memory";
    case SL_ERROR_MACHINE:
      return "the machine could not do it, such as open a socket";
    case SL_ERROR_REFUSED:
      return "the daemon refuses; sl_get_state says why";
    case SL_ERROR_INTERNAL:
      return "a bug in libsightline";
    default:
      return "no status of libsightline";
  }
}
