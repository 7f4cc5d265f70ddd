// Every file that the program reads, with bytes changed, cut out, doubled or put in. The real program reads
// it: it ends by itself, soon, in little memory, with one sentence. CLEARWAY_MUTATIONS sets how many of each
// kind.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <random>

#include "datasets/sources/recording.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/history/provenance.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/mutated_bytes.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace mutated_inputs_test {

struct ProgramRun {
  int status = -1;  ///< -1: killed by a signal
  long memory_kb = 0;
  double seconds = 0;
  std::string log;
};

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool is_sanitized = true;  // takes many times the time and the memory
#else
constexpr bool is_sanitized = false;
#endif
constexpr rlim_t most_seconds = is_sanitized ? 60 : 20;  ///< of processor; what hangs ends there

ProgramRun run_program(std::vector<std::string> arguments, const std::string& log) {
  arguments.insert(arguments.begin(), CLEARWAY_BINARY);
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_RDWR);
    const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    for (const auto& [from, to] : {std::pair{nowhere, 0}, std::pair{nowhere, 1}, std::pair{file, 2}})
      ::dup2(from, to);
    const rlimit time{most_seconds, most_seconds};
    ::setrlimit(RLIMIT_CPU, &time);
    ::alarm(3 * most_seconds);
    ::execv(words[0], words.data());
    ::_exit(127);
  }
  ProgramRun run;
  int status = 0;
  rusage used{};
  while (::wait4(child, &status, 0, &used) < 0 && errno == EINTR) {
  }
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  run.memory_kb = used.ru_maxrss;
  run.seconds = static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec);
  run.log = read_file(log);
  return run;
}

class MutatedInputs : public ::testing::Test {
 protected:
  /// `command` reads `file`, of which `whole` is the sound content.
  void expect_read_or_refused(const std::string& file, const std::string& whole,
                              const std::vector<std::string>& command) {
    for (int i = 0; i < mutations(3); ++i) {
      const std::string bytes = mutated(whole, random_);
      folder_.write(file, bytes);
      const ProgramRun run = run_program(command, folder_.file("log"));
      std::size_t sentences = 0;
      for (std::size_t at = 0; (at = run.log.find("clearway: ", at)) != std::string::npos; ++at) ++sentences;
      // What is read as sound is worked with: reading alone is bounded where the file is refused. A damaged
      // recording (status 3) is worked with as far as it goes, beside libraries of some 128 MB.
      const long least_mb = run.status == 3 ? 132 : 128;
      const long most_kb =
          run.status < 2 ? 512 * 1024 : least_mb * 1024 + 20 * static_cast<long>(bytes.size()) / 1024;
      const bool is_modest = is_sanitized || (run.seconds <= 5.0 && run.memory_kb <= most_kb);
      const bool good = run.status >= 0 && run.status <= 3 && is_modest &&
                        (run.status < 2 || sentences == 1) && run.log.find('\x1b') == std::string::npos;
      if (good) continue;
      const std::string kept =
          ::testing::TempDir() + "mutated-" + std::filesystem::path(file).filename().string();
      std::filesystem::copy_file(folder_.file(file), kept, std::filesystem::copy_options::overwrite_existing);
      ADD_FAILURE() << kept << ": status " << run.status << ", " << run.seconds << " s, " << run.memory_kb
                    << " kB\n"
                    << run.log.substr(0, 2000);
    }
  }

  TemporaryFolder folder_;
  std::mt19937 random_{1};
};

const std::string bench = std::string(CLEARWAY_SOURCE_DIR) + "/datasets/suites/maps/workbench.bt";

TEST_F(MutatedInputs, a_plan) {
  const std::string plan = folder_.file("plan.json");
  run_command({"plan", "--map", bench, "--robot", "arm5", "--start", "0,0,0,0,0", "--goal", "0.1,0,0,0,0",
               "--planner", "rrtconnect", "--out", plan});
  ASSERT_TRUE(std::filesystem::exists(plan));
  expect_read_or_refused("plan.json", read_file(plan), {"check", plan, "--map", bench, "--robot", "arm5"});
}

TEST_F(MutatedInputs, a_suite_and_a_robots_settings) {
  const std::string suite =
      "worlds: [{name: w, resolution: 0.1, sensors: [[0, 0, 1]], sensor_range: 2, solids: [{name: s, box: "
      "[1, 1, "
      "0.1]}]}]\nplanners: [{planner: rrtconnect}]\ntime_limit: 0.1\nexperiments: [{name: e, robot: point, "
      "world: w, "
      "problems: [{name: p, start: [0, 0], goals: [[1, 0]]}]}]\n";
  expect_read_or_refused("suite.yaml", suite,
                         {"compare", folder_.file("suite.yaml"), "--out", folder_.file("out")});
  for (const char* kind : {".yaml", ".urdf"}) {
    const std::string name = std::string("planar2") + kind;
    folder_.write(name, read_file(std::filesystem::path(CLEARWAY_SOURCE_DIR) / "datasets/robots" / name));
  }
  expect_read_or_refused("planar2.yaml", read_file(folder_.file("planar2.yaml")),
                         {"plan", "--map", bench, "--robot", folder_.file("planar2.yaml"), "--start", "0,0",
                          "--goal", "0.1,0", "--planner", "rrtconnect"});
}

TEST_F(MutatedInputs, a_scene_and_a_setup) {
  folder_.write("setup.yaml", small_setup);
  const std::string out = folder_.file("out.rawlog");
  expect_read_or_refused("scene.yaml", small_scene, {"simulate", folder_.file("scene.yaml"), "--out", out});
  folder_.write("scene.yaml", small_scene);
  expect_read_or_refused("setup.yaml", small_setup, {"simulate", folder_.file("scene.yaml"), "--out", out});
}

TEST_F(MutatedInputs, a_recording) {
  RecordingWriter writer(folder_.file("whole.rawlog"));
  std::mt19937 random(1);
  for (int i = 0; i < 10; ++i) {
    CloudFrame cloud;
    for (int k = 0; k < 200; ++k)
      cloud.points.emplace_back(1.0F, static_cast<float>(random() % 100) / 100, 0.0F);
    writer.write(Frame{1000.0 + i, "cloud", cloud});
  }
  writer.finish();
  expect_read_or_refused("r.rawlog", read_file(folder_.file("whole.rawlog")),
                         {"replay", folder_.file("r.rawlog"), "--out", folder_.file("out")});
}

TEST_F(MutatedInputs, a_map_folder) {
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("tool", {"hand"});
  map.begin_stroke("first", "test");
  for (int i = 0; i < 20; ++i) map.paint(volume, {{0.02 * i, 0.2, 0.3}, 0.1}, i);
  map.end_stroke();
  const auto folder = folder_.path() / "map";
  save_map(map.snapshot(), folder);
  save_provenance(map.provenance(), folder);
  const std::vector<std::string> inspect = {"inspect", folder.string(), "--at", "0.1,0.2,0.3"};
  for (const char* file : {"painted.csv", "provenance.bin", "map.ot"}) {
    const std::string whole = read_file(folder / file);
    expect_read_or_refused(std::string("map/") + file, whole, inspect);
    folder_.write(std::string("map/") + file, whole);
  }
  export_map(map.snapshot(), folder / "map.ot");  // of another program: painted.csv is read
  expect_read_or_refused("map/painted.csv", read_file(folder / "painted.csv"), inspect);
}

}  // namespace mutated_inputs_test
}  // namespace clearway
