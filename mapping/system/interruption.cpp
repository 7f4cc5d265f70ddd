#include "mapping/system/interruption.hpp"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace clearway {
namespace {

struct OngoingWork {
  const UnfinishedWork* key;
  std::function<std::string()> end;
  std::filesystem::path below;
};

struct State {
  std::recursive_mutex mutex;
  std::vector<OngoingWork> unfinished;
  std::vector<std::filesystem::path> written;
  std::function<void(int)> ask;  ///< of who ends in order at the first signal; may be empty
  bool is_waiting = false;       ///< a thread waits for signals: only then is what was written reported
};

/// Never destroyed: a signal may come while the process ends.
State& state() {
  static State& only = *new State;
  return only;
}

void add_clause(std::string& sentence, const std::string& clause) {
  if (!clause.empty()) sentence += (sentence.empty() ? "" : "; ") + clause;
}

/// Ends all work, what began last first. With the lock held. What ends may write files, and so begin and end
/// work of its own: a copy is gone through.
std::string end_all_work(State& all) {
  std::string sentence;
  const std::vector<OngoingWork> ongoing = all.unfinished;
  for (auto work = ongoing.rbegin(); work != ongoing.rend(); ++work) add_clause(sentence, work->end());
  for (const auto& file : all.written) add_clause(sentence, "'" + file.string() + "' is written whole");
  return sentence.empty() ? "nothing was written" : sentence;
}

bool is_below(const std::filesystem::path& file, const std::filesystem::path& folder) {
  if (folder.empty()) return false;
  const auto differ = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return differ.first == folder.end();
}

/// SIGINT, SIGTERM, SIGHUP, but none that the process was started to ignore.
sigset_t signals_to_wait_for() {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction present {};
    sigaction(number, nullptr, &present);
    if (present.sa_handler != SIG_IGN) sigaddset(&set, number);
  }
  return set;
}

}  // namespace

void end_in_order_on_signals(std::function<void(int, const std::string&)> end) {
  const sigset_t set = signals_to_wait_for();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  state().is_waiting = true;
  try {
    std::thread([set, end = std::move(end)] {
      State& all = state();
      while (true) {
        int number = 0;
        if (sigwait(&set, &number) != 0) continue;
        const std::lock_guard held(all.mutex);  // to the end: nobody publishes anything after the sentence
        if (const auto ask = std::exchange(all.ask, nullptr)) {
          ask(number);
          continue;
        }
        end(number, end_all_work(all));
        ::_exit(128 + number);
      }
    }).detach();
  } catch (const std::system_error&) {  // no thread to be had: signals end the process as they always did
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  }
}

std::unique_lock<std::recursive_mutex> uninterrupted() { return std::unique_lock(state().mutex); }

UnfinishedWork::UnfinishedWork(std::function<std::string()> end, std::filesystem::path below) {
  const auto held = uninterrupted();
  state().unfinished.push_back({this, std::move(end), std::move(below)});
}

UnfinishedWork::~UnfinishedWork() {
  const auto held = uninterrupted();
  std::erase_if(state().unfinished, [this](const OngoingWork& work) { return work.key == this; });
}

OrderlyEnd::OrderlyEnd(std::function<void(int)> ask) {
  const auto held = uninterrupted();
  state().ask = std::move(ask);
}

OrderlyEnd::~OrderlyEnd() {
  const auto held = uninterrupted();
  state().ask = nullptr;
}

void written_file(const std::filesystem::path& file) {
  const auto held = uninterrupted();
  State& all = state();
  const bool is_part = std::any_of(all.unfinished.begin(), all.unfinished.end(),
                                   [&](const OngoingWork& work) { return is_below(file, work.below); });
  if (all.is_waiting && !is_part) all.written.push_back(file);
}

}  // namespace clearway
