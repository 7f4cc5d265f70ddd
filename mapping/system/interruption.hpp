#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

namespace clearway {

/// From now on SIGINT, SIGTERM and SIGHUP end the process in order: work that is under way removes its
/// temporary files, and `end` gets the signal and a sentence's rest that says what is there ("'out' is as it
/// was"). A thread of its own waits for the signals, so that nothing here runs inside a signal handler. A
/// signal that is ignored, as below nohup, stays ignored. To be called by main, once, before any other thread
/// starts: threads that start earlier would be ended by the signal at once.
void end_in_order_on_signals(std::function<void(int signal, const std::string& what_is_there)> end);

/// While it is held, no signal ends the process and no other thread begins or ends unfinished work: for the
/// steps that must not be cut in two, which take milliseconds.
[[nodiscard]] std::unique_lock<std::recursive_mutex> uninterrupted();

/// Work that a signal would leave unfinished, for as long as this object lives.
class UnfinishedWork {
 public:
  /// @param end called when a signal comes: removes what is temporary and returns a clause about what is
  ///        there, or "". It must not throw.
  /// @param below files below this folder are part of the work: written_file() does not count them.
  explicit UnfinishedWork(std::function<std::string()> end, std::filesystem::path below = {});
  ~UnfinishedWork();
  UnfinishedWork(const UnfinishedWork&) = delete;
  UnfinishedWork& operator=(const UnfinishedWork&) = delete;
};

/// While one lives, the first signal ends nothing: the thread that waits for signals calls `ask` with it, and
/// the work ends itself in order. A second one ends the process as any does. One at a time.
class OrderlyEnd {
 public:
  /// @param ask must not throw, and takes microseconds
  explicit OrderlyEnd(std::function<void(int signal)> ask);
  ~OrderlyEnd();
  OrderlyEnd(const OrderlyEnd&) = delete;
  OrderlyEnd& operator=(const OrderlyEnd&) = delete;
};

/// Remembers a file or folder that was written whole, for the sentence after a signal.
void written_file(const std::filesystem::path& file);

}  // namespace clearway
