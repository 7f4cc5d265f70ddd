#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <ostream>
#include <stdexcept>

#include "apps/console/commands.hpp"
#include "apps/console/named_places.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/quantile.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/console/table.hpp"
#include "apps/fusion/emptiness.hpp"
#include "apps/fusion/open_frames.hpp"
#include "apps/fusion/painter.hpp"
#include "apps/fusion/tag_search.hpp"
#include "apps/fusion/taken_cameras.hpp"
#include "apps/track/image_poses.hpp"
#include "apps/track/pose_marks.hpp"
#include "apps/track/pose_text.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/atomic_folder.hpp"
#include "mapping/system/parallel.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

namespace {

using Json = nlohmann::ordered_json;

/// What became of the poses of one thing.
struct PoseTally {
  std::size_t accepted = 0;
  std::map<std::string, std::size_t> refused;  ///< by word
  std::vector<double> rms;                     ///< of the accepted ones
};

/// What `track` has found so far: files, text for the output, and counts.
class TrackReport {
 public:
  TrackReport(const TrackOptions& options, const Setup& setup, bool keep_json)
      : options_(options), setup_(setup), keep_json_(keep_json), csv_(poses_csv_header()) {
    if (!options.draw.empty()) drawn_.emplace(options.draw, is_drawn);
  }

  void add(const Frame& frame, const ImagePoses& poses, const ImageFrame& image) {
    cameras_.see(frame, setup_);
    ++images_;
    refused_images_ += poses.refusal.empty() ? 0 : 1;
    if (refusal_.empty()) refusal_ = poses.refusal;
    for (const TagDetection& tag : poses.tags) ids_.insert(tag.id);
    for (const ImagePose& pose : poses.poses) count(pose);
    csv_ += to_csv(poses);
    if (keep_json_) json_ += (json_.empty() ? "" : ",\n") + to_json(poses);
    add_line(poses.find("camera", "camera", "map"), poses.time, tum_camera_);
    if (setup_.probe) add_line(poses.find("body", setup_.probe->board, "map"), poses.time, tum_probe_);
    if (drawn_) draw(poses, image);
  }

  /// All files that were asked for.
  void write() {
    if (!options_.csv.empty()) save_file(options_.csv, csv_);
    if (!options_.tum_camera.empty()) save_file(options_.tum_camera, tum_header("camera") + tum_camera_);
    if (!options_.tum_probe.empty()) save_file(options_.tum_probe, tum_header("probe") + tum_probe_);
    if (drawn_) drawn_->publish();
  }

  std::string json(const std::string& setup_source, const FrameSource& source) const {
    Json head{{"source", options_.source.string()},
              {"setup", setup_source},
              {"covariance", "of (v, w), m and rad: true pose = pose * [Exp(w), v]"}};
    head["cameras"] = Json::array();
    for (const TakenCamera& camera : cameras(source))
      head["cameras"].push_back({{"sensor", camera.sensor},
                                 {"taken_as", camera.is_rectified ? "rectified" : "raw"},
                                 {"known_by", camera.known_by}});
    head["summary"] = Json::array();
    for (const auto& [name, tally] : tallies_)
      head["summary"].push_back({{"what", name}, {"accepted", tally.accepted}, {"refused", tally.refused}});
    const std::string text = head.dump(2, ' ', false, Json::error_handler_t::replace);
    return text.substr(0, text.size() - 2) + ",\n  \"images\": [\n" + json_ + "\n  ]\n}\n";
  }
  const std::string& csv() const { return csv_; }
  std::size_t images() const { return images_; }

  /// Of the images; depth is not tracked.
  std::vector<TakenCamera> cameras(const FrameSource& source) const {
    std::vector<TakenCamera> all = cameras_.all(source);
    std::erase_if(all, [&](const TakenCamera& camera) { return !cameras_.has_seen(camera.sensor); });
    return all;
  }

  std::vector<std::vector<std::string>> table() const {
    std::vector<std::vector<std::string>> rows{{"what", "accepted", "median rms px", "refused"}};
    for (const auto& [name, tally] : tallies_) {
      std::string refused;
      for (const auto& [word, count] : tally.refused)
        refused += (refused.empty() ? "" : ", ") + word + " " + grouped(count);
      rows.push_back({name, grouped(tally.accepted),
                      tally.rms.empty() ? "" : significant(quantile(tally.rms, 0.5), 3), refused});
    }
    return rows;
  }

  /// Why there is not one pose, be it refused; "" when there is.
  std::string why_nothing() const {
    if (poses_ > 0) return "";
    if (images_ == 0) return "it holds no image";
    const std::string images = "its " + counted(images_, "image");
    if (refused_images_ == images_) return "none of " + images + " is the camera's: " + refusal_;
    if (ids_.empty()) return "no tag is seen in " + images;
    const std::string tags = "the tags in " + images + " (ids " + list_of_ids(ids_) + ")";
    const bool is_any_known = std::any_of(ids_.begin(), ids_.end(), [&](int id) {
      return std::any_of(setup_.boards.begin(), setup_.boards.end(), [&](const BoardSetup& board) {
        return std::any_of(board.tags.begin(), board.tags.end(),
                           [&](const TagSetup& tag) { return tag.id == id; });
      });
    });
    return is_any_known ? "no pose explains " + tags : "none of " + tags + " is on a board of the setup";
  }

 private:
  static bool is_drawn(const std::filesystem::path& relative) {
    const std::string name = relative.string();
    return relative.extension() == ".png" && name.find_first_not_of("0123456789") == 6;
  }
  static std::string tum_header(const std::string& what) {
    return "# map_from_" + what + ": time x y z qx qy qz qw (s, m)\n";
  }
  static void add_line(const ImagePose* pose, double time, std::string& lines) {
    if (pose != nullptr && pose->is_accepted()) lines += tum_line(time, pose->pose->pose);
  }

  void count(const ImagePose& pose) {
    const std::string name = pose.kind == "tag"       ? "tags in the camera"
                             : pose.frame == "camera" ? pose.name + " in the camera"
                                                      : pose.name + " in the map";
    PoseTally& tally = tallies_[name];
    poses_ += pose.pose ? 1 : 0;
    if (!pose.is_accepted()) {
      ++tally.refused[pose.refusal];
      return;
    }
    ++tally.accepted;
    if (pose.rms_px) tally.rms.push_back(*pose.rms_px);
  }

  void draw(const ImagePoses& poses, const ImageFrame& image) {
    char number[16];
    std::snprintf(number, sizeof number, "%06zu", images_ - 1);
    const std::string stem = std::filesystem::path(poses.file).stem().string();
    const cv::Mat gray(image.image.height, image.image.width, CV_8UC1,
                       const_cast<std::uint8_t*>(image.image.pixels.data()));
    const std::vector<ImageMark> marks =
        poses.refusal.empty() ? marks_of(poses, setup_, camera_of(setup_, image)) : std::vector<ImageMark>();
    save_file(drawn_->path() / (std::string(number) + (stem.empty() ? "" : "-" + stem) + ".png"),
              annotated_png(gray, marks));
  }

  const TrackOptions& options_;
  const Setup& setup_;
  bool keep_json_;
  std::optional<AtomicFolder> drawn_;
  std::string csv_, json_, tum_camera_, tum_probe_, refusal_;
  std::size_t images_ = 0, refused_images_ = 0, poses_ = 0;
  std::set<int> ids_;
  TakenCameras cameras_;
  std::map<std::string, PoseTally> tallies_;
};

/// Refuses files that cannot be written, or that are read, before any work.
void require_outputs(const TrackOptions& options, const std::filesystem::path& setup) {
  const std::vector<NamedPlace> files = {{"--csv", options.csv},
                                         {"--json", options.json},
                                         {"--tum-camera", options.tum_camera},
                                         {"--tum-probe", options.tum_probe}};
  std::vector<NamedPlace> outputs = files;
  outputs.push_back({"--draw", options.draw});
  require_apart(outputs, {{"SOURCE", options.source}, {"--setup", setup}});
  require_not_in(files, {"SOURCE", options.source});
  for (const NamedPlace& file : files)
    if (!file.path.empty()) require_writable(file.path);
}

}  // namespace

int run_track(const TrackOptions& options, Console& console) {
  const std::filesystem::path file =
      options.setup.empty() ? options.setup : shipped_file("setups", options.setup);
  require_outputs(options, file);
  ChosenSetup chosen = choose_setup(options.source, file);
  chosen.setup.source.camera_seconds = options.camera_seconds;
  const Setup& setup = chosen.setup;
  if (setup.boards.empty())
    throw std::invalid_argument(
        chosen.source == "none"
            ? "track: no setup, neither by --setup nor in the recording: expected one "
              "with the `boards` whose tags are to be tracked"
            : "setup (" + chosen.source + "): expected `boards` whose tags are to be tracked");
  ImagePoseFinder finder(setup);
  TrackReport report(options, setup, console.json || !options.json.empty());
  const std::unique_ptr<FrameSource> frames = open_frames(options.source, setup.source);
  const std::size_t threads = options.threads > 0
                                  ? static_cast<std::size_t>(options.threads)
                                  : static_cast<std::size_t>(setup.detector.threads.value_or(
                                        static_cast<int>(std::min<std::size_t>(thread_count(), 8))));
  TagDetectorOptions detector = tracking_options(setup).detector;
  detector.drop_duplicates = false;  // each has a pose of its own
  TagSearch search(*frames, detector, threads);
  const auto progress = console.bar("tracking");
  while (const auto searched = search.next()) {
    if (const auto* image = std::get_if<ImageFrame>(&searched->frame.content))
      report.add(searched->frame, finder.find(searched->frame, *image, searched->tags), *image);
    progress(frames->progress());
  }
  progress(1.0);
  for (const std::string& warning : frames->warnings()) console.warn("warning: " + warning);
  if (const std::string caveat = frames->time_caveat(); !caveat.empty()) console.warn("warning: " + caveat);
  if (report.images() == 0 && !frames->damage())
    throw std::invalid_argument(options.source.string() + ": " + report.why_nothing());
  report.write();
  const std::string json = console.json || !options.json.empty() ? report.json(chosen.source, *frames) : "";
  if (!options.json.empty()) save_file(options.json, json);
  if (console.json) {
    console.out() << json;
  } else if (options.csv.empty() && options.json.empty()) {
    console.out() << report.csv();
  } else {
    std::vector<std::pair<std::string, std::string>> cameras;
    for (const TakenCamera& camera : report.cameras(*frames))
      cameras.emplace_back("camera " + camera.sensor, shown(camera));
    print_rows(console.out(), cameras);
    print_table(console.out(), report.table());
  }
  if (const auto damage = frames->damage()) {
    console.warn("clearway: " + *damage);
    return exit_damaged;
  }
  const std::string nothing = report.why_nothing();
  if (nothing.empty()) return exit_done;
  console.warn("clearway: " + options.source.string() + ": " + nothing);
  return exit_no;
}

}  // namespace clearway
