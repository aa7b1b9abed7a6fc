#include "main_view/client/c_api/failure.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>

#include "common/error.hpp"

namespace sightline::c_api {
namespace {

/// What a thread keeps: a program seldom works with more handles at once in one thread.
constexpr std::size_t k_kept = 8;

struct Noted {
  const void* handle = nullptr;
  std::array<char, 480> text{};
};

/// The newest failure of each handle, newest first. Trivial, so that a thread's end has nothing to do.
struct Notes {
  std::array<Noted, k_kept> noted{};
  std::size_t count = 0;
};
thread_local constinit Notes notes;

}  // namespace

void note_failure(const void* handle, const char* text) noexcept {
  std::size_t place = 0;
  while (place < notes.count && notes.noted[place].handle != handle) ++place;
  if (place == notes.count) {
    if (notes.count < k_kept) ++notes.count;
    place = notes.count - 1;
  }
  for (; place > 0; --place) notes.noted[place] = notes.noted[place - 1];
  Noted& newest = notes.noted[0];
  newest.handle = handle;
  const std::size_t size = std::min(std::strlen(text), newest.text.size() - 1);
  std::memcpy(newest.text.data(), text, size);
  newest.text[size] = '\0';
}

sl_status note_current_exception(const void* handle) noexcept {
  const auto note = [handle](sl_status status, const char* text) {
    note_failure(handle, text);
    return status;
  };
  try {
    throw;
  } catch (const Failure& failure) {
    return note(failure.status, failure.text.c_str());
  } catch (const InputError& error) {
    return note(SL_ERROR_ARGUMENT, error.what());
  } catch (const MachineError& error) {
    return note(SL_ERROR_MACHINE, error.what());
  } catch (const std::bad_alloc&) {
    return note(SL_ERROR_MEMORY, sl_status_text(SL_ERROR_MEMORY));
  } catch (const std::length_error& error) {
    return note(SL_ERROR_MEMORY, error.what());
  } catch (const std::exception& error) {
    return note(SL_ERROR_INTERNAL, error.what());
  } catch (...) {
    return note(SL_ERROR_INTERNAL, sl_status_text(SL_ERROR_INTERNAL));
  }
}

}  // namespace sightline::c_api

extern "C" const char* sl_last_error(const void* handle) {
  using namespace sightline::c_api;
  for (std::size_t i = 0; i < notes.count; ++i) {
    if (handle == nullptr || notes.noted[i].handle == handle) return notes.noted[i].text.data();
  }
  return "";
}
