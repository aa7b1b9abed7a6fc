#pragma once

namespace sightline::c_api {

/// Throws Failure (SL_ERROR_MACHINE) unless the process can open as many files as a connection takes. libzmq
/// ends the process when it runs out of them while it makes a context; a program that is short of them shall
/// be told. What other threads open in the same moment is not seen.
void require_descriptors();

}  // namespace sightline::c_api
