// What `clearway` leaves to `clearway-full`, so that it need not load VTK, MRPT and OpenCV before every
// command: the functions below take the place of those that use these libraries. Each is called before its
// command has said or written anything, and begins the command anew in the other program, in the same
// process.
#include <unistd.h>

#include <cerrno>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "apps/console/commands.hpp"
#include "apps/inspect/inspect_recording.hpp"
#include "mapping/files/cloud_parser.hpp"
#include "mapping/scans/cloud_filters.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

std::vector<std::string> own_arguments() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> arguments;
  for (std::string argument; std::getline(file, argument, '\0');) arguments.push_back(argument);
  return arguments;
}

[[noreturn]] void hand_over() {
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path full = own.parent_path().parent_path() / "libexec" / "clearway-full";
  std::vector<std::string> arguments = own_arguments();
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  execv(full.c_str(), pointers.data());
  throw std::runtime_error(quote_path(full.string()) +
                           " cannot be started: " + std::system_category().message(errno) +
                           ": expected it as installed with clearway");
}

}  // namespace

int run_replay(const ReplayOptions&, Console&) { hand_over(); }
int run_simulate(const SimulateOptions&, Console&) { hand_over(); }
int inspect_recording(const InspectOptions&, Console&) { hand_over(); }
int run_tags_print(const TagsPrintOptions&, Console&) { hand_over(); }
int run_calibrate(const CalibrateOptions&, Console&) { hand_over(); }
int run_teach(const TeachCommand&, Console&) { hand_over(); }
int run_track(const TrackOptions&, Console&) { hand_over(); }

ParsedCloud parse_cloud(const std::filesystem::path&) { hand_over(); }
std::vector<Eigen::Vector3f> one_point_per_cube(const std::vector<Eigen::Vector3f>&, double) { hand_over(); }
std::vector<int> inliers(const std::vector<Eigen::Vector3f>&, int, double) { hand_over(); }

}  // namespace clearway
