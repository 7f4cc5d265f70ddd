#include "datasets/pictures/picture_times.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "datasets/cameras/phone_paths.hpp"
#include "datasets/pictures/camera_path.hpp"
#include "datasets/pictures/name_time.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/pictures/polycam_path.hpp"
#include "datasets/sources/clock_seconds.hpp"
#include "datasets/sources/finite_number.hpp"
#include "mapping/system/child_process.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_table = 64U << 20U;
constexpr std::size_t exif_reach = 256U << 10U;  ///< bytes of a file within which its EXIF must lie

constexpr char no_times[] = "the pictures have no times";
constexpr char shared_times[] =
    "EXIF states one time for several of the pictures, as of a burst without SubSecTimeOriginal";
constexpr char fine_times[] =
    "the numbers in the pictures' names would be years apart as seconds, and are taken as nanoseconds or "
    "microseconds from a start; a table, or `rate` of `source` in the setup, gives true ones";
constexpr char taken_times[] =
    ": they are taken as one a second, or by the numbers in their names; a table, or `rate` of `source` in "
    "the "
    "setup, gives true ones";

/// The first fields of a line, apart by commas, semicolons or blanks.
std::vector<std::string> fields_of(const std::string& line, std::size_t most) {
  std::vector<std::string> fields;
  const std::string apart = line.find(',') != std::string::npos   ? ",\r"
                            : line.find(';') != std::string::npos ? ";\r"
                                                                  : " \t\r";
  for (std::size_t at = 0; at < line.size() && fields.size() < most;) {
    const std::size_t end = std::min(line.find_first_of(apart, at), line.size());
    std::string field = line.substr(at, end - at);
    field.erase(0, field.find_first_not_of(" \t\""));
    field.erase(field.find_last_not_of(" \t\"") + 1);
    if (!field.empty()) fields.push_back(field);
    at = end + 1;
  }
  return fields;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The digits at `at`, without leading zeros; `at` goes behind them.
std::string digits_at(const std::string& text, std::size_t& at) {
  while (at + 1 < text.size() && text[at] == '0' && is_digit(text[at + 1])) ++at;
  const std::size_t begin = at;
  while (at < text.size() && is_digit(text[at])) ++at;
  return text.substr(begin, at - begin);
}

bool are_distinct(const std::vector<double>& times) {
  return std::set<double>(times.begin(), times.end()).size() == times.size();
}

/// Numbers within names count by their value: a9 before a10.
bool comes_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string first = digits_at(a, i), second = digits_at(b, j);
      if (first.size() != second.size()) return first.size() < second.size();
      if (first != second) return first < second;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i, ++j;
    }
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

std::vector<fs::path> tables_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error))
    if (extension_of(entry.path()) == ".csv") found.push_back(entry.path());
  return found;
}

/// What `track --csv` writes: times that it took are not those of a clock.
constexpr char track_titles[] = "time,file,kind,";

using Parse = std::vector<std::pair<std::string, double>> (*)(const std::string&, const std::string&);

/// The lines of a table of times by the names of their files without a folder.
class TimesTable {
 public:
  explicit TimesTable(const std::vector<std::pair<std::string, double>>& lines) {
    for (const auto& [file, time] : lines) {
      const fs::path path = file;
      by_name_[path.filename().string()].push_back({path.parent_path().filename().string(), time});
    }
  }

  std::size_t size() const { return by_name_.size(); }

  /// Of several lines with this name the first that names the file's folder, too; else, where they name
  /// different folders, none.
  std::optional<double> time_of(const fs::path& file, const std::string& folder) const {
    const auto found = by_name_.find(file.filename().string());
    if (found == by_name_.end()) return std::nullopt;
    const std::vector<Entry>& entries = found->second;
    for (const Entry& entry : entries)
      if (entry.folder == folder) return entry.time;
    const bool is_one = std::all_of(entries.begin(), entries.end(),
                                    [&](const Entry& entry) { return entry.folder == entries[0].folder; });
    return is_one ? std::optional(entries.front().time) : std::nullopt;
  }

 private:
  struct Entry {
    std::string folder;
    double time;
  };
  std::map<std::string, std::vector<Entry>> by_name_;
};

/// A sentence where something gives some of these pictures no time.
std::vector<std::string> told_untimed(const std::string& name, std::size_t without_time, std::size_t files) {
  if (without_time == 0) return {};
  return {name + " has no time for " + std::to_string(without_time) + " of " + counted(files, "picture") +
          ", which are left out"};
}

TimedFiles times_by_table(const std::vector<fs::path>& files, const fs::path& table,
                          Parse parse = parse_file_times) {
  const std::string name = "times " + quote_path(table.string());
  const std::string text = read_input(table, "times", largest_table);
  if (text.starts_with(track_titles))
    throw std::invalid_argument(name +
                                " is what `track --csv` wrote, expected lines 'time, file' of a clock");
  const TimesTable times(parse(text, name));
  TimedFiles result;
  std::error_code error;
  const fs::path parent = files.front().parent_path();
  const std::string folder = fs::weakly_canonical(parent.empty() ? "." : parent, error).filename().string();
  for (const fs::path& file : files)
    if (const auto time = times.time_of(file, folder)) result.files.push_back({file, *time});
  if (result.files.empty())
    throw std::invalid_argument(name + ": it names none of the " + counted(files.size(), "picture") +
                                ", expected lines 'time, file'");
  result.warnings = told_untimed(name, files.size() - result.files.size(), files.size());
  const std::size_t missing = times.size() - result.files.size();
  if (missing > 0 && parse == parse_file_times)  // associations name those of another camera, too
    result.warnings.push_back(name + " names " + counted(missing, "picture that is", "pictures that are") +
                              " not there");
  return result;
}

/// Whether a line's first fields name one of these files; not of a table that `track` wrote, or of one too
/// large to be of times.
bool names_any_of(const fs::path& table, const std::vector<fs::path>& files) {
  std::error_code error;
  if (const auto size = fs::file_size(table, error); error || size > largest_table) return false;
  const std::string text = read_input(table, "times", largest_table);
  if (text.starts_with(track_titles)) return false;
  std::set<std::string> names;
  for (const fs::path& file : files) names.insert(file.filename().string());
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    for (const std::string& field : fields_of(line, 2))
      if (names.count(fs::path(field).filename().string()) > 0) return true;
  return false;
}

/// What the first of these tables says that is there and about these files.
std::optional<TimedFiles> times_by_first(const std::vector<fs::path>& files,
                                         const std::vector<fs::path>& tables, Parse parse) {
  std::error_code error;
  for (const fs::path& table : tables) {
    if (!fs::is_regular_file(table, error)) continue;
    try {
      return times_by_table(files, table, parse);
    } catch (const std::invalid_argument&) {  // it is about something else
    }
  }
  return std::nullopt;
}

/// What the one table in the folder says that is about these files; another alone is reported.
/// @throws std::invalid_argument where one is about them and cannot be used, or several are
/// @param unused takes a sentence for each table that is about something else
std::optional<TimedFiles> times_by_table_inside(const std::vector<fs::path>& files, const fs::path& folder,
                                                std::vector<std::string>& unused) {
  std::optional<TimedFiles> found;
  for (const fs::path& table : tables_in(folder)) {
    if (!names_any_of(table, files)) {
      unused.push_back("table " + quote_path(table.string()) +
                       " gives none of the pictures a time and is not used");
      continue;
    }
    if (found)
      throw std::invalid_argument(
          "folder " + quote_path(folder.string()) +
          " has several .csv files that name its pictures, expected one with their times");
    found = times_by_table(files, table);
  }
  return found;
}

/// What FOLDER.csv or FOLDER.txt beside the folder says, if it is about these files.
std::optional<TimedFiles> times_by_neighbour(const std::vector<fs::path>& files, const fs::path& folder) {
  const std::string beside = folder.string();
  return times_by_first(files, {beside + ".csv", beside + ".txt"}, parse_file_times);
}

/// What TUM's associations in the folder or beside it say, if they are about these files.
std::optional<TimedFiles> times_by_associations(const std::vector<fs::path>& files, const fs::path& folder) {
  std::vector<fs::path> tables;
  for (const fs::path& place : {folder, folder.parent_path()})
    for (const char* name : {"associations.txt", "association.txt", "associate.txt", "associated.txt"})
      tables.push_back(place / name);
  return times_by_first(files, tables, parse_associations);
}

std::string beginning_of(const fs::path& file) {
  const InputFile input(file, "picture");
  std::string bytes(std::min(input.size(), exif_reach), '\0');
  std::size_t got = 0;
  while (got < bytes.size()) {
    const ssize_t part =
        ::pread(input.descriptor(), bytes.data() + got, bytes.size() - got, static_cast<off_t>(got));
    if (part <= 0) break;
    got += static_cast<std::size_t>(part);
  }
  bytes.resize(got);
  return bytes;
}

/// One number a file, below 0 where it has none; none at all when reading them takes the child down.
std::optional<std::vector<double>> exif_times(const std::vector<fs::path>& files) {
  const ChildLimits limits{.memory = 128U << 20U,
                           .output = sizeof(double) * files.size(),
                           .seconds = 10 + static_cast<int>(files.size() / 20),
                           .patience = 8};
  const ChildOutcome outcome = run_in_child(
      [&]() {
        std::string bytes;
        for (const fs::path& file : files) {
          const double time = exif_time(beginning_of(file));
          bytes.append(reinterpret_cast<const char*>(&time), sizeof time);
          if (time < 0.0) break;
        }
        return bytes;
      },
      limits);
  if (!outcome.finished || outcome.parts.size() != 1) return std::nullopt;
  std::vector<double> times(outcome.parts.front().size() / sizeof(double));
  std::copy_n(outcome.parts.front().data(), times.size() * sizeof(double),
              reinterpret_cast<char*>(times.data()));
  const bool whole = times.size() == files.size() &&
                     std::all_of(times.begin(), times.end(), [](double t) { return t >= 0.0; });
  if (!whole) return std::nullopt;
  return times;
}

std::optional<std::vector<double>> name_times(const std::vector<fs::path>& files) {
  std::vector<double> times;
  for (const fs::path& file : files) {
    const auto time = time_in_name(file.stem().string());
    if (!time) return std::nullopt;
    times.push_back(*time);
  }
  return times;
}

/// Whether names say when a picture was taken; frames that are numbered do not.
bool are_clock(const std::vector<fs::path>& files) {
  const auto times = name_times(files);
  return times && are_distinct(*times) &&
         (*std::max_element(times->begin(), times->end()) >= clock_begins ||
          std::any_of(times->begin(), times->end(), [](double time) { return time != std::floor(time); }));
}

std::vector<std::pair<std::string, double>> in_seconds(const std::vector<std::string>& files,
                                                       std::vector<double> times) {
  make_seconds(times);
  std::vector<std::pair<std::string, double>> pairs;
  for (std::size_t i = 0; i < files.size(); ++i) pairs.emplace_back(files[i], times[i]);
  return pairs;
}

std::vector<TimedFile> together(const std::vector<fs::path>& files, const std::vector<double>& times) {
  std::vector<TimedFile> timed;
  for (std::size_t i = 0; i < files.size(); ++i) timed.push_back({files[i], times[i]});
  return timed;
}

/// @param files in the order of their times
void require_one_unit(const std::vector<fs::path>& files, const std::vector<double>& times) {
  const auto other = of_another_unit(times);
  if (!other) return;
  const auto name = [](const fs::path& file) { return quote(file.filename().string()); };
  throw std::invalid_argument("the names " + name(files[*other]) + " and " + name(files.back()) +
                              " hold times of a clock in two units, expected one: seconds, or milliseconds, "
                              "microseconds or nanoseconds since 1970");
}

std::vector<TimedFile> evenly_timed(const std::vector<fs::path>& files, double rate) {
  std::vector<double> times(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) times[i] = static_cast<double>(i) / rate;
  return together(files, times);
}

/// Polycam's pictures, depth and colour alike, are called by their microseconds.
std::optional<std::vector<TimedFile>> times_of_polycam(const std::vector<fs::path>& files,
                                                       const fs::path& folder) {
  if (polycam_cameras(folder.parent_path()).empty()) return std::nullopt;
  auto times = name_times(files);
  if (!times || !are_distinct(*times)) return std::nullopt;
  for (double& time : *times) time *= 1e-6;
  return together(files, *times);
}

/// What Record3D or ScanNet++ say in a file beside the folder, of depth and colour pictures alike, so that
/// both have one clock: pictures that it does not list are left out. Nothing where it lists none of them, or
/// cannot be read, which is for those to say that need its poses.
std::optional<TimedFiles> times_of_phone(const std::vector<fs::path>& files, const fs::path& folder) try {
  const fs::path file = phone_path_file(folder.parent_path());
  if (file.empty()) return std::nullopt;
  const std::string name = "poses " + quote_path(file.string());
  std::map<std::string, double> known;
  for (const CameraShot& shot : parse_camera_path(read_input(file, "poses", largest_table), name).shots)
    if (shot.time) known[shot.picture] = *shot.time;
  std::vector<double> times;
  for (const auto& [picture, time] : known) times.push_back(time);
  TimedFiles result;
  for (const fs::path& picture : files)
    if (const auto found = known.find(picture.stem().string()); found != known.end())
      result.files.push_back({picture, found->second});
  if (result.files.empty() || !are_distinct(times)) return std::nullopt;
  result.warnings = told_untimed(name, files.size() - result.files.size(), files.size());
  return result;
} catch (const std::invalid_argument&) {
  return std::nullopt;
}

/// Of pictures as far apart as no hand paints, in whole numbers: times may be finer than seconds.
std::string slow_times(const std::vector<TimedFile>& files) {
  constexpr std::size_t few = 5;
  constexpr double slow = 10.0;  // s
  if (files.size() < few) return "";
  std::vector<double> steps;
  for (std::size_t i = 1; i < files.size(); ++i) {
    steps.push_back(files[i].time - files[i - 1].time);
    if (steps.back() != std::floor(steps.back())) return "";
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle < slow
             ? ""
             : "the pictures are some " + short_text(*middle) +
                   " s apart: are their times milliseconds? Limits of speed and pauses go by seconds";
}

}  // namespace

std::vector<fs::path> in_order_of_names(std::vector<fs::path> files) {
  if (const auto times = name_times(files)) {
    std::vector<TimedFile> timed = together(files, *times);
    std::sort(timed.begin(), timed.end(), [](const TimedFile& a, const TimedFile& b) {
      return std::tie(a.time, a.file) < std::tie(b.time, b.file);
    });
    for (std::size_t i = 0; i < files.size(); ++i) files[i] = std::move(timed[i].file);
    return files;
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return comes_before(a.filename().string(), b.filename().string());
  });
  return files;
}

std::vector<std::pair<std::string, double>> parse_file_times(const std::string& text,
                                                             const std::string& name) {
  std::istringstream lines(text);
  std::vector<std::string> files;
  std::vector<double> times;
  int number = 0;
  bool has_titles = false;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line.resize(std::min(line.find('#'), line.size()));
    const std::vector<std::string> fields = fields_of(line, 2);
    if (fields.empty()) continue;
    const auto first = finite_number(fields[0]);
    const auto second = fields.size() == 2 ? finite_number(fields[1]) : std::nullopt;
    if (!first && !second && !has_titles && files.empty()) {
      has_titles = true;
      continue;
    }
    if (fields.size() != 2 || (!first && !second))
      throw std::invalid_argument(name + ", line " + std::to_string(number) +
                                  ": expected a time and a file's name, got " + quote(line));
    files.push_back(first ? fields[1] : fields[0]);
    times.push_back(first ? *first : *second);
  }
  return in_seconds(files, times);
}

std::vector<std::pair<std::string, double>> parse_associations(const std::string& text,
                                                               const std::string& name) {
  std::istringstream lines(text);
  std::vector<std::string> files;
  std::vector<double> times;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line.resize(std::min(line.find('#'), line.size()));
    const std::vector<std::string> fields = fields_of(line, 5);
    if (fields.empty()) continue;
    for (const std::size_t at : {0U, 2U}) {
      const auto time = fields.size() == 4 ? finite_number(fields[at]) : std::nullopt;
      if (!time)
        throw std::invalid_argument(name + ", line " + std::to_string(number) +
                                    ": expected a time and a file's name twice, got " + quote(line));
      files.push_back(fields[at + 1]);
      times.push_back(*time);
    }
  }
  return in_seconds(files, times);
}

std::vector<TimedFile> times_of_names(const std::vector<fs::path>& given) {
  const std::vector<fs::path> files = in_order_of_names(given);
  auto times = name_times(files);
  if (!times || !are_distinct(*times)) return evenly_timed(files, 1.0);
  if (count_from_zero(*times)) return together(files, finer_than_seconds(*times));
  require_one_unit(files, *times);
  make_seconds(*times);
  return together(files, *times);
}

std::string names_caveat(const std::vector<fs::path>& given, const std::string& scans) {
  const std::vector<fs::path> files = in_order_of_names(given);
  const auto numbers = name_times(files);
  if (files.size() < 2) return "";
  if (numbers && are_distinct(*numbers) && count_from_zero(*numbers))
    return "the numbers in the " + scans +
           "' names would be years apart as seconds, and are taken as "
           "nanoseconds or microseconds from a start: ages of voxels count by that";
  if (are_clock(files)) return "";
  return "the names of the " + scans + " hold no clock's times: they are taken " +
         (numbers && are_distinct(*numbers) ? "by the numbers in them, in seconds"
                                            : "in the order of their names, as one a second") +
         ": which scan is the newest, and ages of voxels, go by that";
}

TimedFiles times_of_files(const std::vector<fs::path>& given, std::optional<double> rate) {
  const std::vector<fs::path> files = in_order_of_names(given);
  if (rate) return {evenly_timed(files, *rate), {}, ""};

  TimedFiles result;
  std::error_code error;
  const fs::path parent = files.front().parent_path();
  const fs::path folder = fs::weakly_canonical(parent.empty() ? "." : parent, error);
  const bool is_clock = are_clock(files);
  std::vector<std::string> unused;
  if (auto inside = times_by_table_inside(files, parent, unused)) {
    result = std::move(*inside);
  } else if (auto neighbour = times_by_neighbour(files, folder)) {
    result = std::move(*neighbour);
  } else if (auto microseconds = times_of_polycam(files, folder)) {
    result.files = std::move(*microseconds);
  } else if (auto of_phone = times_of_phone(files, folder)) {
    result = std::move(*of_phone);
  } else if (const auto exif = exif_times(files); exif && are_distinct(*exif)) {
    result.files = together(files, *exif);
  } else if (auto associated = is_clock ? std::nullopt : times_by_associations(files, folder)) {
    result = std::move(*associated);
  } else {
    result.files = times_of_names(files);
    if (const auto numbers = name_times(files);
        numbers && are_distinct(*numbers) && count_from_zero(*numbers))
      result.time_caveat = fine_times;
    else if (!is_clock && files.size() > 1)
      result.time_caveat = std::string(exif ? shared_times : no_times) + taken_times;
  }
  result.warnings.insert(result.warnings.end(), unused.begin(), unused.end());
  std::stable_sort(result.files.begin(), result.files.end(),
                   [](const TimedFile& a, const TimedFile& b) { return a.time < b.time; });
  if (const std::string doubt = slow_times(result.files); !doubt.empty()) result.warnings.push_back(doubt);
  return result;
}

}  // namespace clearway
