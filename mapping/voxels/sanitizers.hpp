#pragma once

// Which sanitizers this is compiled with: gcc and clang say it in different ways.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CLEARWAY_ADDRESS_SANITIZED
#endif
#if __has_feature(thread_sanitizer)
#define CLEARWAY_THREAD_SANITIZED
#endif
#endif

namespace clearway {

#if defined(__SANITIZE_ADDRESS__) || defined(CLEARWAY_ADDRESS_SANITIZED)
constexpr bool address_sanitized = true;
#else
constexpr bool address_sanitized = false;
#endif

#if defined(__SANITIZE_THREAD__) || defined(CLEARWAY_THREAD_SANITIZED)
constexpr bool thread_sanitized = true;
#else
constexpr bool thread_sanitized = false;
#endif

}  // namespace clearway
