// clearway teach in a window that is ended by signals: what a person did is kept, and can be done again.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "mapping/files/map_file.hpp"
#include "mapping/system/file_descriptor.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace teach_signal_test {

namespace fs = std::filesystem;

constexpr const char* strokes = R"({"time": 0.2, "action": "paint_on"}
{"time": 1.2, "action": "paint_off"}
{"time": 1.3, "action": "robot", "robot": "point", "base": [0, 0, 0.2], "policies": {"default": "not_occupied"}}
{"time": 1.3, "action": "start", "q": "0,0"}
{"time": 1.3, "action": "goal", "q": "0.1,0"}
{"time": 1.4, "action": "plan", "name": "slow", "planner": "rrtstar"}
{"time": 1.5, "action": "paint_on"}
)";

class SignalledSession : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string scene = small_scene;
    scene.replace(scene.find("duration: 0.5"), 13, "duration: 20");
    folder_ = std::make_unique<TemporaryFolder>();
    folder_->write("setup.yaml", small_setup);
    folder_->write("scene.yaml", scene);
    folder_->write("events.jsonl", strokes);
    const CommandRun run =
        run_command({"simulate", folder_->file("scene.yaml"), "--out", folder_->file("r.rawlog"), "--quiet"});
    ASSERT_EQ(run.status, exit_done) << run.log;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  void TearDown() override {
    for (const char* name : {"taught", "taught.partial", "again"}) fs::remove_all(*folder_ / name);
  }

  static std::string log() { return read_file(*folder_ / "log"); }

  /// Teaches at the recording's own pace and sends the signals as soon as the log says this.
  /// @return as waitpid reports it
  static int teach(const std::string& moment, const std::vector<int>& signals) {
    folder_->write("log", "");
    const pid_t child = ::fork();
    if (child == 0) run_program();
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (log().find(moment) == std::string::npos && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_NE(log().find(moment), std::string::npos) << log();
    for (const int number : signals) ::kill(child, number);
    int status = 0;
    ::waitpid(child, &status, 0);
    return status;
  }

  static CommandRun replay(const std::string& session) {
    return run_command({"replay", folder_->file(session), "--out", folder_->file("again")});
  }

  static std::size_t balls(const std::string& map) {
    const Snapshot loaded = load_map(*folder_ / map);
    return loaded.volumes().at(0).spheres.size();
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;

 private:
  [[noreturn]] static void run_program() {
    ::setenv("QT_QPA_PLATFORM", "offscreen", 1);  // a window that needs no display
    ::setenv("WAYLAND_DISPLAY", "none", 1);
    for (const int number : {SIGINT, SIGTERM}) ::signal(number, SIG_DFL);
    const int log = ::open(folder_->file("log").c_str(), O_WRONLY | O_APPEND);
    ::dup2(log, STDERR_FILENO);
    ::dup2(log, STDOUT_FILENO);
    const std::string recording = folder_->file("r.rawlog"), events = folder_->file("events.jsonl"),
                      out = folder_->file("taught");
    ::execl(CLEARWAY_BINARY, CLEARWAY_BINARY, "teach", recording.c_str(), "--events", events.c_str(), "--out",
            out.c_str(), "--time-limit", "1000", static_cast<char*>(nullptr));
    ::_exit(127);
  }
};

TEST_F(SignalledSession, QuitsAtTheFirstSignalAndIsDoneAgainByteForByte) {
  for (const char* moment : {"paint_on  [painting]", "paint_off  [ready]"}) {
    SCOPED_TRACE(moment);
    const int signal = std::string(moment).starts_with("paint_on") ? SIGTERM : SIGINT;
    const int status = teach(moment, {signal});
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), exit_done) << log();
    const std::string sentence =
        "clearway: SIG" + std::string(::sigabbrev_np(signal)) + " ends the session, which is saved";
    EXPECT_NE(log().find(sentence), std::string::npos) << log();
    EXPECT_FALSE(fs::exists(*folder_ / "taught.partial"));
    const std::string events = read_file(*folder_ / "taught/session/events.jsonl");
    EXPECT_NE(events.find("\"action\":\"quit\""), std::string::npos) << events;
    EXPECT_EQ(replay("taught/session").status, exit_done);
    for (const char* name : {"map.ot", "painted.csv", "provenance.bin", "session/events.jsonl"})
      EXPECT_EQ(read_file(*folder_ / "taught" / name), read_file(*folder_ / "again" / name)) << name;
    TearDown();
  }
}

TEST_F(SignalledSession, QuitsWhileAPlanIsMade) {
  const auto begin = std::chrono::steady_clock::now();
  const int status = teach("plan slow  [planning]", {SIGINT});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(100));  // a tenth of its time
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), exit_no) << log();  // a plan was asked for
  EXPECT_NE(log().find("the session ended before it was made"), std::string::npos) << log();
  EXPECT_GT(balls("taught"), 0U);
  const std::string events = read_file(*folder_ / "taught/session/events.jsonl");
  EXPECT_EQ(events.find("slow"), std::string::npos) << events;
  EXPECT_EQ(replay("taught/session").status, exit_done);
  EXPECT_EQ(read_file(*folder_ / "taught/map.ot"), read_file(*folder_ / "again/map.ot"));
}

TEST_F(SignalledSession, LeavesWhatASecondSignalOrAKillFoundThereToBeDoneAgain) {
  for (const std::vector<int>& signals : {std::vector{SIGINT, SIGTERM}, std::vector{SIGKILL}}) {
    SCOPED_TRACE(signals.size());
    const int status = teach("paint_off  [ready]", signals);
    EXPECT_FALSE(fs::exists(*folder_ / "taught"));
    if (signals.size() == 2) {
      ASSERT_TRUE(WIFEXITED(status));
      EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
      const std::string sentence =
          "ended by SIGTERM: '" + folder_->file("taught") + "' is not written; the session so far is in '" +
          folder_->file("taught.partial") + "'; `clearway replay '" +
          folder_->file("taught.partial/session") + "' --out DIR` makes its map and plans\n";
      EXPECT_NE(log().find(sentence), std::string::npos) << log();
    }
    const auto begin_another = [&] {
      return run_command({"teach", "/dev/video99", "--setup", folder_->file("setup.yaml"), "--events",
                          folder_->file("events.jsonl"), "--headless", "--out", folder_->file("taught")});
    };
    {
      const FileDescriptor held = open_to_read(*folder_ / "taught.partial");  // as by one that goes on
      ASSERT_TRUE(lock(held, false));
      const CommandRun refused = begin_another();
      EXPECT_EQ(refused.status, exit_bad_input);
      EXPECT_NE(refused.log.find("another session is being taught into"), std::string::npos) << refused.log;
    }
    const CommandRun refused = begin_another();
    EXPECT_EQ(refused.status, exit_bad_input);
    EXPECT_NE(refused.log.find("taught.partial' holds a session that was not finished"), std::string::npos)
        << refused.log;
    const CommandRun again = replay("taught.partial/session");
    EXPECT_EQ(again.status, exit_damaged) << again.log;  // its recording ends early
    EXPECT_GT(balls("again"), 0U);
    const std::string events = read_file(*folder_ / "taught.partial/session/events.jsonl");
    EXPECT_EQ(std::count(events.begin(), events.end(), '\n'), 2) << events;
    TearDown();
  }
}

TEST_F(SignalledSession, LeavesAFirstStrokeThatASecondSignalCutShort) {
  const int status = teach("paint_on  [painting]", {SIGINT, SIGTERM});
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == exit_done) return;  // it was saved before the second one came
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
  EXPECT_NE(read_file(*folder_ / "taught.partial/session/events.jsonl").find("paint_on"), std::string::npos);
  EXPECT_EQ(replay("taught.partial/session").status, exit_damaged);
}

}  // namespace teach_signal_test
}  // namespace clearway
