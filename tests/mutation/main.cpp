// mutation_check: puts small faults into the code that decides what is free, blocked, proved and accepted,
// one at a time, and counts those that the tests notice. See README.md.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <thread>

#include "tests/mutation/accepted.hpp"
#include "tests/mutation/costs.hpp"
#include "tests/mutation/draw.hpp"
#include "tests/mutation/records.hpp"
#include "tests/mutation/test_program.hpp"

namespace clearway::mutation {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::size_t count = 200;
  std::uint64_t seed = 1;
  unsigned jobs = std::max(1U, std::thread::hardware_concurrency());
  std::string repository = CLEARWAY_SOURCE_DIR, build = CLEARWAY_BUILD_DIR, only;
  bool trust_noticed = false, try_accepted = false, list = false, named = false;
};

/// Tries candidates in their order until `count` of them did compile.
class Check {
 public:
  explicit Check(const Options& options)
      : options_(options),
        accepted_(fs::path(options.repository) / "tests/mutation/accepted_survivors.txt"),
        records_(fs::path(options.build) / "mutation" / "records.txt", options.trust_noticed) {
    const auto is_left_out = [&](const std::string& file) {
      return file.find(options.only) == std::string::npos;
    };
    if (options.named) {
      candidates_ =
          named(options.repository, fs::path(options.repository) / "tests/mutation/named_faults.txt");
      std::erase_if(candidates_, [&](const Candidate& candidate) { return is_left_out(candidate.file); });
      options_.count = candidates_.size();
    } else {
      std::vector<std::string> files = deciding_files(options.repository);
      std::erase_if(files, is_left_out);
      candidates_ = drawn(options.repository, files, options.seed);
    }
    std::erase_if(candidates_, [&](const Candidate& candidate) {
      return accepted_.reason(candidate).starts_with("equivalent: ");
    });
    outcomes_.resize(candidates_.size());
  }

  void list() const {
    for (std::size_t i = 0; i < std::min(options_.count, candidates_.size()); ++i)
      std::cout << candidates_[i].name() << "\n    " << candidates_[i].text << "\n";
  }

  void run() {
    for (const std::string floor : {"mapping", "planning", "tracking", "datasets", "apps"}) {
      const bool is_asked =
          std::any_of(candidates_.begin(), candidates_.end(),
                      [&](const Candidate& candidate) { return candidate.file.starts_with(floor + "/"); });
      if (is_asked)
        programs_[floor] = std::make_unique<TestProgram>(options_.repository, options_.build, floor, costs_);
    }
    at_once([this](const fs::path& folder) { work(folder); });
    find_reach();
    at_once([this](const fs::path& folder) { work_on_open(folder); });
    for (const auto& [floor, program] : programs_)
      program->verify(outcomes_of(floor), folder_of("faultless"));
    fs::remove_all(folder_of("faultless"));
  }

  /// 0: enough were noticed, and each of the others is explained.
  int report() const {
    std::size_t noticed = 0, accepted = 0, unexplained = 0, broken = 0;
    for (std::size_t i = 0; i < next_ && i < candidates_.size(); ++i) {
      const Outcome& outcome = outcomes_[i];
      const std::string reason = accepted_.reason(candidates_[i]);
      broken += outcome.kind == Outcome::Kind::not_compiled;
      noticed += outcome.kind == Outcome::Kind::noticed;
      if (outcome.kind == Outcome::Kind::survived) (reason.empty() ? unexplained : accepted)++;
    }
    std::cout << "\nSurvivors:\n";
    for (std::size_t i = 0; i < next_ && i < candidates_.size(); ++i) {
      if (outcomes_[i].kind != Outcome::Kind::survived) continue;
      const Candidate& candidate = candidates_[i];
      const std::string reason = accepted_.reason(candidate);
      std::cout << "file: " << candidate.file << "\nline: " << candidate.text
                << "\nfault: " << candidate.fault.kind << ": " << candidate.change << "\nreason: " << reason
                << "\n\n";
    }
    const std::size_t faults = noticed + accepted + unexplained;
    const double share =
        faults == 0 ? 0.0 : 100.0 * static_cast<double>(noticed) / static_cast<double>(faults);
    std::cout << faults << " faults, " << (options_.named ? "named" : "seed " + std::to_string(options_.seed))
              << ": " << noticed << " noticed (" << std::floor(10.0 * share) / 10.0 << " %), " << accepted
              << " survivors explained, " << unexplained << " not explained; " << broken
              << " more did not compile\n";
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin_;
    std::cout << std::lround(wall.count()) << " s, " << costs_.told() << "\n";
    return faults > 0 && share >= 95.0 && unexplained == 0 ? 0 : 1;
  }

 private:
  /// The next candidate to try; false when enough are tried or under way.
  bool take(std::size_t& index) {
    const std::lock_guard lock(mutex_);
    if (problem_ || counted_ + under_way_ >= options_.count || next_ == candidates_.size()) return false;
    index = next_++;
    ++under_way_;
    return true;
  }

  /// Runs `work` in as many threads as are asked for, each with a folder of its own.
  template <typename Work>
  void at_once(const Work& work) {
    std::vector<std::thread> workers;
    for (unsigned i = 0; i < options_.jobs; ++i)
      workers.emplace_back([&, folder = folder_of(std::to_string(i))] {
        try {
          work(folder);
        } catch (...) {
          const std::lock_guard lock(mutex_);
          problem_ = std::current_exception();
        }
        fs::remove_all(folder);
      });
    for (std::thread& worker : workers) worker.join();
    if (problem_) std::rethrow_exception(problem_);
  }

  fs::path folder_of(const std::string& name) const {
    return fs::path(options_.build) / "mutation" / (std::to_string(::getpid()) + "_" + name);
  }

  void work(const fs::path& folder) {
    std::size_t index = 0;
    // One that does not compile is replaced: who finds nothing to take waits for those under way.
    while (!is_done()) {
      if (!take(index)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        continue;
      }
      const bool is_known = !options_.try_accepted && !accepted_.reason(candidates_[index]).empty();
      const Outcome outcome = is_known ? Outcome{Outcome::Kind::survived, "as its reason says"}
                                       : outcome_nearby(candidates_[index], folder);
      const std::lock_guard lock(mutex_);
      --under_way_;
      counted_ += outcome.kind != Outcome::Kind::not_compiled;
      if (outcome.kind == Outcome::Kind::open) open_.push_back(index);
      tell(index, outcome);
    }
  }

  /// What near tests did not notice is tried by the floor's others, of which only those are run that run its
  /// place.
  void find_reach() {
    for (const auto& [floor, program] : programs_) {
      std::vector<Candidate> of_floor;
      for (const std::size_t index : open_)
        if (candidates_[index].file.starts_with(floor + "/")) of_floor.push_back(candidates_[index]);
      const fs::path folder = folder_of("probes");
      program->find_reach(of_floor, folder);
      fs::remove_all(folder);
    }
  }

  std::vector<Outcome> outcomes_of(const std::string& floor) const {
    std::vector<Outcome> outcomes;
    for (std::size_t i = 0; i < next_; ++i)
      if (candidates_[i].file.starts_with(floor + "/")) outcomes.push_back(outcomes_[i]);
    return outcomes;
  }

  void work_on_open(const fs::path& folder) {
    for (;;) {
      std::size_t index = 0;
      {
        const std::lock_guard lock(mutex_);
        if (problem_ || open_.empty()) return;
        index = open_.back();
        open_.pop_back();
      }
      const Outcome outcome = program_of(candidates_[index]).tried_by_others(candidates_[index], folder);
      records_.add(key_of(candidates_[index]), program_of(candidates_[index]).digest(), outcome);
      const std::lock_guard lock(mutex_);
      tell(index, outcome);
    }
  }

  void tell(std::size_t index, const Outcome& outcome) {
    outcomes_[index] = outcome;
    std::cout << candidates_[index].name() << "\n    " << to_string(outcome.kind)
              << (outcome.by.empty() ? "" : ": ") << outcome.by << std::endl;
  }

  bool is_done() {
    const std::lock_guard lock(mutex_);
    return problem_ || (under_way_ == 0 && (counted_ >= options_.count || next_ == candidates_.size()));
  }

  TestProgram& program_of(const Candidate& candidate) {
    return *programs_.at(candidate.file.substr(0, candidate.file.find('/')));
  }

  std::string key_of(const Candidate& candidate) const {
    const std::string source = read_whole(fs::path(options_.repository) / candidate.file);
    return std::to_string(hash_of(candidate.file + "\n" + candidate.fault.applied_to(source)));
  }

  Outcome outcome_nearby(const Candidate& candidate, const fs::path& folder) {
    TestProgram& program = program_of(candidate);
    const std::string key = key_of(candidate);
    if (const auto known = records_.find(key, program.digest())) return *known;
    const Outcome outcome = program.tried_nearby(candidate, folder);
    records_.add(key, program.digest(), outcome);
    return outcome;
  }

  Options options_;
  AcceptedSurvivors accepted_;
  Records records_;
  std::vector<Candidate> candidates_;
  std::vector<Outcome> outcomes_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  Costs costs_;
  std::map<std::string, std::unique_ptr<TestProgram>> programs_;
  std::mutex mutex_;
  std::size_t next_ = 0, under_way_ = 0, counted_ = 0;
  std::vector<std::size_t> open_;  ///< not noticed by the tests near them
  std::exception_ptr problem_;
};

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app("Puts small faults into the code that decides, and counts those that the tests notice.");
  app.add_option("--count", options.count, "faults that compile")->capture_default_str();
  app.add_option("--seed", options.seed, "of the draw")->capture_default_str();
  app.add_option("--jobs", options.jobs, "at a time")->capture_default_str();
  app.add_option("--build", options.build, "build folder (Ninja), test programs up to date")
      ->capture_default_str();
  app.add_option("--only", options.only, "files whose path has this in it");
  app.add_flag("--trust-noticed", options.trust_noticed,
               "try survivors of earlier runs again, not what was noticed");
  app.add_flag("--try-accepted", options.try_accepted,
               "try accepted survivors as well; else they count as not noticed without being tried");
  app.add_flag("--named", options.named, "the faults of named_faults.txt instead of drawn ones");
  app.add_flag("--list", options.list, "print the faults, try none");
  CLI11_PARSE(app, argc, argv);
  Check check(options);
  if (options.list) {
    check.list();
    return 0;
  }
  check.run();
  return check.report();
}

}  // namespace
}  // namespace clearway::mutation

int main(int argc, char** argv) {
  try {
    return clearway::mutation::main_of(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "mutation_check: " << error.what() << "\n";
    return 2;
  }
}
