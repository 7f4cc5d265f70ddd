#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// A picture of a folder and when it was taken.
struct TimedFile {
  std::filesystem::path file;
  double time = 0;  ///< s
};

/// Pictures in the order of their times, with what was left out in sentences.
struct TimedFiles {
  std::vector<TimedFile> files;
  std::vector<std::string> warnings;
  std::string time_caveat;  ///< one sentence when nothing says their times; else ""
};

/// Lines "time, file" or "file, time" (also apart by spaces), `#` and a line of titles left out, as pairs of
/// a file as it is written there and its time in seconds. @throws std::invalid_argument naming `name`, the
/// line and what was expected.
std::vector<std::pair<std::string, double>> parse_file_times(const std::string& text,
                                                             const std::string& name);

/// TUM's associations: lines "time, file, time, file", as pairs like parse_file_times.
std::vector<std::pair<std::string, double>> parse_associations(const std::string& text,
                                                               const std::string& name);

/// In the order of names: of the times that they are, else with numbers within names by their value.
std::vector<std::filesystem::path> in_order_of_names(std::vector<std::filesystem::path> files);

/// Files in the order of their names, numbers within names by their value (a9 before a10), each with its
/// time: that in its name, where all have one and none is there twice (numbers that would be years apart as
/// seconds count nanoseconds or microseconds), else its place in that order, one a second.
/// @throws std::invalid_argument naming two files whose times are those of a clock in two units
std::vector<TimedFile> times_of_names(const std::vector<std::filesystem::path>& files);

/// The sentence about times of names that are no clock's, of scans: "clouds"; empty where they are, or there
/// is one file alone.
std::string names_caveat(const std::vector<std::filesystem::path>& files, const std::string& scans);

/// The first of these that gives every file a time, none of them twice: the table of times beside them; their
/// names as microseconds, beside Polycam's cameras; what Record3D or ScanNet++ say beside them; their EXIF;
/// their names, as times_of_names reads them. A rate goes before all of them. The table is the one .csv file
/// in the folder that names one of them, FOLDER.csv or FOLDER.txt beside it, or TUM's associations.txt in or
/// beside it, unless names are a clock's; files that it, or what a phone says, does not name are left out and
/// reported.
/// @param files of one folder, at least one
/// @throws std::invalid_argument for a table about these files that cannot be read, or several of them
TimedFiles times_of_files(const std::vector<std::filesystem::path>& files, std::optional<double> rate);

}  // namespace clearway
