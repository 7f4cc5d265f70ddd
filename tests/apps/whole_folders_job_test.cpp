// replay, inspect --save and compare over an older folder: whatever fails or ends them, the older set or the
// new one is there, whole. CLEARWAY_KILLS says how often they are killed at random times (12 by default);
// with CLEARWAY_TRIALS=many every call to the disk fails, else a third of them and the last ones.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "mapping/files/map_file.hpp"
#include "mapping/system/interruption.hpp"
#include "tests/apps/faulty_disk/faulty_disk.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/small_scene.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace whole_folders_job_test {

namespace fs = std::filesystem;

/// A wall of points; `gap` distinguishes the clouds.
std::string cloud(double gap) {
  std::string points;
  int count = 0;
  for (int y = -5; y <= 5; ++y) {
    for (int z = 0; z <= 3; ++z, ++count)
      points += "1.05 " + std::to_string(0.1 * y + gap) + " " + std::to_string(0.1 * z) + "\n";
  }
  const std::string number = std::to_string(count);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + number +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\nDATA ascii\n" + points;
}

constexpr const char* setup = R"(
map: {resolution: 0.1}
robot: {name: point, base: [0, 0, 0.05, 0, 0, 0]}
queries:
  - {name: aside, start: [-1, 0], goals: [[-1, 0.5]], planners: [rrtconnect], policies: {default: not_occupied},
     allow_outside: [base]}  # it stands behind the sensor
)";

constexpr const char* suite = R"(
title: One step
seed: 3
worlds:
  - {name: wall, resolution: 0.1, sensors: [[0, 0, 0.02]], sensor_range: 2,
     solids: [{name: wall, box: [0.1, 1, 0.3], pose: [1, 0, 0, 0, 0, 0]}]}
experiments:
  - {name: step, robot: point, world: wall, policies: {default: not_occupied}, planners: [{planner: rrtconnect}],
     problems: [{name: back, start: [0, 0], goals: [[-1, 0]]}, {name: aside, start: [0, 0], goals: [[0, -1]]}]}
)";

using Content = std::map<std::string, std::string>;

Content content(const fs::path& folder) {
  Content found;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      found[entry.path().lexically_relative(folder).string()] = read_file(entry.path());
  return found;
}

/// Without the pages of the worst runs: which run is slowest is a matter of times.
std::vector<std::string> names(const Content& files) {
  std::vector<std::string> found;
  for (const auto& [name, text] : files)
    if (!name.starts_with("worst/")) found.push_back(name);
  return found;
}

/// How a command ended that ran in a process of its own.
struct Ending {
  int status = 0;  ///< as waitpid reports it
  long calls = 0;  ///< to the disk
  std::string log;
};

class WholeFolders : public ::testing::TestWithParam<const char*> {
 protected:
  /// In memory, where there is such a file system: what waits for a disk would take minutes.
  static void SetUpTestSuite() {
    if (fs::is_directory("/dev/shm")) ::setenv("TMPDIR", "/dev/shm", 0);
  }

  void SetUp() override {
    base_.write("new.pcd", cloud(0.0));
    base_.write("old.pcd", cloud(0.03));
    base_.write("setup.yaml", setup);
    base_.write("suite.yaml", suite);
    base_.write("small.yaml", std::string(suite).replace(std::string(suite).find("seed: 3"), 7, "seed: 4"));
    ASSERT_EQ(run_command({"replay", base_.file("new.pcd"), "--setup", base_.file("setup.yaml"), "--out",
                           base_.file("map"), "--quiet"})
                  .status,
              exit_done);
    make_older_set();
    const Ending ending = run(0, 0);
    ASSERT_TRUE(WIFEXITED(ending.status) && WEXITSTATUS(ending.status) == 0) << ending.log;
    new_ = content(out());
    calls_ = ending.calls;
  }

  std::string kind() const { return GetParam(); }
  fs::path work() const { return base_.path() / "work"; }
  fs::path out() const { return work() / "out"; }

  std::vector<std::string> command(bool is_new) const {
    const std::string folder = out().string();
    if (kind() == "compare")
      return {"compare",  // one page, so that all runs make as many calls
              base_.file(is_new ? "suite.yaml" : "small.yaml"),
              "--out",
              folder,
              "--worst-pages",
              "1",
              "--quiet"};
    if (kind() == "inspect")
      return {
          "inspect", base_.file("map"), "--crop", is_new ? "-1,-1,-1,2,2,2" : "-1,-1,-1,0.5,2,2", "--save",
          folder,    "--quiet"};
    // The recording lies in the folder that is replaced, as ./demo has it.
    return {"replay",  is_new ? (out() / "mine.pcd").string() : base_.file("old.pcd"),
            "--setup", base_.file("setup.yaml"),
            "--out",   folder,
            "--quiet"};
  }

  void make_older_set() {
    ASSERT_EQ(run_command(command(false)).status, exit_done);
    fs::copy_file(base_.path() / "new.pcd", out() / "mine.pcd");
    old_ = content(out());
    fs::copy(work(), base_.path() / "pristine", fs::copy_options::recursive);
  }

  void restore() const {
    fs::remove_all(work());
    fs::copy(base_.path() / "pristine", work(), fs::copy_options::recursive);
  }

  /// Runs the command that makes the new set, in a process of its own.
  /// @param meanwhile gets the process while it runs
  Ending run(long failing_call, int error, const std::function<void(pid_t)>& meanwhile = {}) const {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
    const pid_t child = ::fork();
    if (child == 0) {
      ::signal(SIGINT, SIG_DFL);  // shells let what runs behind them ignore it
      end_in_order_on_signals([&](int, const std::string& there) {
        const std::string line = "0 clearway: ended: " + there + "\n";
        [[maybe_unused]] const auto written = ::write(ends[1], line.data(), line.size());
      });
      fail_disk_call(failing_call, error);
      const CommandRun ran = run_command(command(true));
      const std::string report = std::to_string(disk_calls()) + " " + ran.log;
      [[maybe_unused]] const auto done = ::write(ends[1], report.data(), report.size());
      ::_exit(ran.status);
    }
    ::close(ends[1]);
    if (meanwhile) meanwhile(child);
    std::string text;
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = ::read(ends[0], buffer.data(), buffer.size())) > 0;)
      text.append(buffer.data(), static_cast<std::size_t>(n));
    ::close(ends[0]);
    Ending ending;
    ::waitpid(child, &ending.status, 0);
    if (const auto space = text.find(' '); space != std::string::npos) {
      ending.calls = std::stol(text);
      ending.log = text.substr(space + 1);
    }
    return ending;
  }

  bool is_old_set() const { return content(out()) == old_; }

  /// The new set's files, the same map and paths; times in plans and reports differ from run to run.
  void expect_new_set() const {
    const Content found = content(out());
    EXPECT_EQ(names(found), names(new_));
    for (const auto& [name, text] : found) {
      if (name.ends_with(".json")) {
        EXPECT_TRUE(nlohmann::json::accept(text)) << name;
      } else if (name.ends_with(".html")) {
        EXPECT_TRUE(text.find("</html>") != std::string::npos) << name;
      } else if (name == "map.ot" || name == "painted.csv" || name == "mine.pcd") {
        EXPECT_EQ(text, new_.at(name)) << name;
      }
    }
    if (fs::exists(out() / "map.ot")) {
      EXPECT_NO_THROW(load_map(out()));
    }
  }

  void expect_one_of_two(const std::string& when) const {
    SCOPED_TRACE(kind() + " " + when);
    if (!is_old_set()) expect_new_set();
  }

  /// What lies beside the folder, a comparison's partial results apart.
  std::size_t temporary_files() const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(work()))
      count += entry.path() != out() && entry.path().filename() != "out.partial";
    return count;
  }

  std::vector<double> random_times(int count) const {
    const auto begin = std::chrono::steady_clock::now();
    run(0, 0);
    const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - begin;
    std::mt19937 dice(static_cast<unsigned>(count));
    std::uniform_real_distribution<double> when(0.0, 1.1 * whole.count());
    std::vector<double> times;
    for (int i = 0; i < count; ++i) times.push_back(when(dice));
    return times;
  }

  static int kills() {
    const char* text = std::getenv("CLEARWAY_KILLS");
    return std::max(1, (text != nullptr ? std::atoi(text) : 12) / 3);
  }

  /// The calls to the disk that shall fail, one at a time. Folders change places in the last ones.
  std::vector<long> failing_calls() const {
    const int apart = trials(3, 1);
    std::vector<long> chosen;
    for (long n = 1; n <= calls_; ++n)
      if (n % apart == 0 || n > calls_ - 12) chosen.push_back(n);
    return chosen;
  }

  const TemporaryFolder base_;
  Content old_, new_;
  long calls_ = 0;
};

TEST_P(WholeFolders, EveryCallToTheDiskMayFail) {
  ASSERT_GT(calls_, 10);
  for (const long n : failing_calls()) {
    SCOPED_TRACE(kind() + ", call " + std::to_string(n) + " of " + std::to_string(calls_));
    restore();
    const Ending ending = run(n, n % 2 == 0 ? ENOSPC : EIO);
    ASSERT_TRUE(WIFEXITED(ending.status));
    EXPECT_EQ(WEXITSTATUS(ending.status), exit_bad_input) << ending.log;
    EXPECT_TRUE(ending.log.starts_with("clearway: ")) << ending.log;
    EXPECT_EQ(std::count(ending.log.begin(), ending.log.end(), '\n'), 1) << ending.log;
    EXPECT_TRUE(is_old_set());
    EXPECT_EQ(temporary_files(), 0U);
  }
}

/// A file system that cannot exchange two names says EINVAL: then the older folder moves aside.
TEST_P(WholeFolders, ACallThatTheFileSystemDoesNotKnowEndsInOneOfTheTwo) {
  int done = 0;
  for (const long n : failing_calls()) {
    SCOPED_TRACE(kind() + ", call " + std::to_string(n) + " of " + std::to_string(calls_));
    restore();
    const Ending ending = run(n, EINVAL);
    ASSERT_TRUE(WIFEXITED(ending.status));
    EXPECT_EQ(is_old_set(), WEXITSTATUS(ending.status) != 0);
    if (WEXITSTATUS(ending.status) != 0) continue;
    expect_new_set();
    ++done;
  }
  EXPECT_GT(done, 0);
}

TEST_P(WholeFolders, AKillBeforeAnyCallToTheDiskLeavesOneOfTheTwo) {
  std::size_t old = 0;
  for (const long n : failing_calls()) {
    restore();
    const Ending ending = run(n, 0);
    if (!WIFSIGNALED(ending.status)) {  // the call was one of the child that reads the recording
      EXPECT_EQ(WEXITSTATUS(ending.status), exit_bad_input) << n;
      EXPECT_NE(ending.log.find("its reader crashed; nothing gets into the map"), std::string::npos)
          << ending.log;
      EXPECT_TRUE(is_old_set());
    }
    expect_one_of_two("killed before call " + std::to_string(n));
    old += is_old_set();
  }
  EXPECT_GT(old, 0U);
  if (fs::exists(work() / "out.partial")) {  // but for runs of a comparison that were finished
    const Ending refused = run(0, 0);
    EXPECT_EQ(WEXITSTATUS(refused.status), exit_bad_input);
    EXPECT_NE(refused.log.find("expected --resume, which goes on with it, or that folder removed"),
              std::string::npos)
        << refused.log;
    fs::remove_all(work() / "out.partial");
  }
  const Ending next = run(0, 0);  // what the killed processes left goes with the next start
  EXPECT_EQ(WEXITSTATUS(next.status), 0) << next.log;
  EXPECT_EQ(temporary_files(), 0U);
  expect_new_set();
}

TEST_P(WholeFolders, AKillAtARandomTimeLeavesOneOfTheTwo) {
  for (const double seconds : random_times(kills())) {
    restore();
    run(0, 0, [&](pid_t child) {
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
      ::kill(child, SIGKILL);
    });
    expect_one_of_two("killed after " + std::to_string(seconds) + " s");
  }
}

TEST_P(WholeFolders, ASignalEndsInASentenceThatSaysWhatIsThere) {
  for (const double seconds : random_times(kills())) {
    restore();
    const Ending ending = run(0, 0, [&](pid_t child) {
      std::this_thread::sleep_for(std::chrono::duration<double>(0.02 + seconds));
      ::kill(child, SIGINT);
    });
    ASSERT_TRUE(WIFEXITED(ending.status));
    EXPECT_EQ(temporary_files(), 0U);
    expect_one_of_two("after " + std::to_string(seconds) + " s");
    if (WEXITSTATUS(ending.status) != 128 + SIGINT) continue;  // it had finished
    const bool is_early =
        ending.log.find("nothing was written") != std::string::npos;  // before it knew where to
    EXPECT_EQ(is_early || ending.log.find("is as it was") != std::string::npos, is_old_set()) << ending.log;
    EXPECT_EQ(ending.log.find("is written whole") != std::string::npos, !is_old_set()) << ending.log;
    const bool has_partial = ending.log.find("out.partial") != std::string::npos;
    EXPECT_EQ(has_partial, fs::exists(work() / "out.partial")) << ending.log;
  }
}

INSTANTIATE_TEST_SUITE_P(Commands, WholeFolders, ::testing::Values("replay", "inspect", "compare"));

/// `simulate` makes two files in a folder that holds others: two renames, and a kill may fall between them.
TEST(WholeSimulation, AfterAKillTheTruthIsOfItsRecordingOrNamesAnother) {
  const TemporaryFolder folder;
  folder.write("setup.yaml", small_setup);
  folder.write("older.yaml", small_scene);
  folder.write("newer.yaml", std::string(small_scene).replace(small_scene.find("seed: 5"), 7, "seed: 6"));
  const auto simulate = [&](const std::string& scene) {
    return run_command(
        {"simulate", folder.file(scene + ".yaml"), "--out", folder.file("r.rawlog"), "--quiet"});
  };
  const auto is_pair = [&] {
    const std::string recording = read_file(folder.file("r.rawlog"));
    const auto named = nlohmann::json::parse(read_file(folder.file("truth.json"))).at("recording");
    const auto* bytes = reinterpret_cast<const Bytef*>(recording.data());
    return named.at("bytes") == recording.size() &&
           named.at("crc32") == ::crc32(0, bytes, static_cast<uInt>(recording.size()));
  };
  ASSERT_EQ(simulate("older").status, exit_done);
  const Content older = content(folder.path());
  ASSERT_EQ(simulate("newer").status, exit_done);
  const Content newer = content(folder.path());
  std::map<std::string, int> left;
  for (long call = 1, status = SIGKILL; status == SIGKILL; ++call) {
    for (const char* name : {"r.rawlog", "truth.json"}) folder.write(name, older.at(name));
    const pid_t child = ::fork();
    if (child == 0) {
      fail_disk_call(call, 0);
      ::_exit(simulate("newer").status);
    }
    int ended = 0;
    ::waitpid(child, &ended, 0);
    status = WIFSIGNALED(ended) ? WTERMSIG(ended) : WEXITSTATUS(ended);
    std::string which;
    for (const char* name : {"r.rawlog", "truth.json"}) {
      const std::string text = read_file(folder.file(name));
      ASSERT_TRUE(text == older.at(name) || text == newer.at(name)) << name << ", call " << call;
      which += text == newer.at(name) ? "newer " : "older ";
    }
    EXPECT_EQ(is_pair(), which == "older older " || which == "newer newer ") << which << ", call " << call;
    ++left[which];
  }
  EXPECT_GT(left["older older "], 0);
  EXPECT_GT(left["newer older "], 0);  // between the two
  EXPECT_GT(left["newer newer "], 0);
  EXPECT_EQ(left["older newer "], 0);
}

}  // namespace whole_folders_job_test
}  // namespace clearway
