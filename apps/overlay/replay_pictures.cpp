#include "apps/overlay/replay_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/fusion/open_frames.hpp"
#include "apps/fusion/painter.hpp"
#include "apps/fusion/tag_search.hpp"
#include "apps/overlay/film.hpp"
#include "apps/overlay/plan_pictures.hpp"
#include "apps/overlay/recording_pictures.hpp"
#include "apps/track/image_poses.hpp"
#include "datasets/pictures/video.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/atomic_folder.hpp"
#include "mapping/system/parallel.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

bool is_still(const std::filesystem::path& relative) {
  const std::string name = relative.string();
  return name.find('/') == std::string::npos &&
         (name.ends_with("-start.png") || name.ends_with("-goal.png") || name.ends_with("-tightest.png") ||
          name.ends_with("-to_paint.png") || name == "painted.png");
}

std::string millimetres(double metres) { return significant(1000.0 * metres, 3) + " mm"; }

/// The view of an image whose camera's pose passes the setup's acceptance.
std::optional<View> view_of(const ImageFrame& frame, const ImagePoses& poses, const Setup& setup,
                            const cv::Mat& image) {
  const ImagePose* camera = poses.find("camera", "camera", "map");
  if (!poses.refusal.empty() || camera == nullptr || !camera->is_accepted()) return std::nullopt;
  return View{image, camera_of(setup, frame), camera->pose->pose.inverse()};
}

void save_png(const std::filesystem::path& file, const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", picture, bytes);
  save_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void save_stills(const std::filesystem::path& folder, const View& view, const Snapshot& map,
                 const OverlayMap& shown, const std::vector<ReplayPlan>& plans) {
  AtomicFolder stills(folder, is_still);
  PlanPictures pictures(view, shown);
  if (plans.empty()) save_png(stills.path() / "painted.png", pictures.painted(map));
  for (const ReplayPlan& entry : plans) {
    const std::string name = entry.query + "-" + entry.plan.planner;
    const auto save = [&](const std::string& what, const cv::Mat& picture) {
      save_png(stills.path() / (name + "-" + what + ".png"), picture);
    };
    if (!entry.plan.is_proved()) {
      save("to_paint", pictures.failed(entry));
      continue;
    }
    const DrawnMotion motion = drawn_motion(entry);
    save("start", pictures.solved(entry, motion, 0, "start"));
    save("goal", pictures.solved(entry, motion, motion.positions.size() - 1, "goal"));
    const double clearance =
        entry.plan.motion ? entry.plan.motion->validation.min_clearance : entry.plan.validation.min_clearance;
    save("tightest", pictures.solved(entry, motion, motion.tightest,
                                     "tightest point, at least " + millimetres(clearance)));
  }
  stills.publish();
}

/// The first solved plan of each query, in time, over one view.
void add_motions(Film& film, const View& view, const OverlayMap& map, const std::vector<ReplayPlan>& plans) {
  PlanPictures pictures(view, map);
  std::set<std::string> shown;
  for (const ReplayPlan& entry : plans) {
    if (!entry.plan.is_proved() || !shown.insert(entry.query).second) continue;
    const DrawnMotion motion = drawn_motion(entry);
    const double duration = motion.period * static_cast<double>(motion.positions.size() - 1);
    const auto count = static_cast<std::size_t>(std::ceil(duration * film.rate()));
    for (std::size_t i = 0; i <= count; ++i) {
      const double time = std::min(static_cast<double>(i) / film.rate(), duration);
      const auto at = std::min(static_cast<std::size_t>(time / motion.period), motion.positions.size() - 1);
      film.add(pictures.solved(entry, motion, at, to_tenths(time) + " of " + to_tenths(duration)));
    }
  }
}

}  // namespace

void require_pictures(const PictureOptions& options, const std::filesystem::path& recording,
                      const std::filesystem::path& out) {
  if (!options.are_asked()) return;
  if (is_camera_name(recording))
    throw std::invalid_argument(
        "--overlay and --video-out read a recording twice: expected a recording, got the "
        "live camera " +
        quote_path(recording.string()));
  const auto whole = [](const std::filesystem::path& path) {
    const std::filesystem::path normal = std::filesystem::weakly_canonical(path);
    return normal.has_filename() ? normal : normal.parent_path();
  };
  if (!options.stills.empty()) {
    if (whole(options.stills) == whole(out))
      throw std::invalid_argument("--overlay: expected another folder than --out, got " +
                                  quote_path(options.stills.string()) + " for both");
    const auto below = whole(options.stills).lexically_relative(whole(out));
    if (below.empty() || *below.begin() == "..") AtomicFolder(options.stills, is_still);
  }
  const auto folder = options.video.parent_path();
  if (!options.video.empty() && whole(folder.empty() ? "." : folder) != whole(out))
    require_writable(options.video);
}

void draw_replay(const std::filesystem::path& recording, const Fusion& fusion, const Snapshot& map,
                 const std::vector<ReplayPlan>& plans, const PictureOptions& options,
                 const std::function<void(double)>& progress) {
  const Setup& setup = fusion.setup;
  if (fusion.counts.images == 0)
    throw std::invalid_argument(
        "--overlay and --video-out draw into images: " + quote_path(recording.string()) + " holds none");
  const std::string board = fixed_board(setup, "drawing into images").name;
  ImagePoseFinder finder(setup);
  const std::unique_ptr<FrameSource> frames = open_frames(recording, setup.source);
  TagDetectorOptions detector = tracking_options(setup).detector;
  detector.drop_duplicates = false;  // as the finder wants it
  TagSearch search(*frames, detector, thread_count());
  std::optional<View> last;
  std::optional<double> start;
  std::optional<RecordingPictures> pictures;
  Film film(options.video);
  if (!options.video.empty()) pictures.emplace(setup, map);
  while (const auto searched = search.next()) {
    const Frame& frame = searched->frame;
    if (!start && !std::holds_alternative<CommentFrame>(frame.content)) start = frame.time;
    progress(frames->progress());
    const auto* image = std::get_if<ImageFrame>(&frame.content);
    if (image == nullptr) continue;
    const ImagePoses poses = finder.find(frame, *image, searched->tags);
    const cv::Mat grey = cv::Mat(image->image.height, image->image.width, CV_8UC1,
                                 const_cast<std::uint8_t*>(image->image.pixels.data()))
                             .clone();
    const std::optional<View> view = view_of(*image, poses, setup, grey);
    if (view) last = view;
    if (!pictures || !poses.refusal.empty()) continue;
    const double since_start = frame.time - *start;
    film.add(frame.time, view ? pictures->draw(*view, poses, since_start)
                              : pictures->draw_lost(grey, poses, since_start));
  }
  if (!last)
    throw std::invalid_argument(
        "--overlay and --video-out: none of the " + counted(fusion.counts.images, "image") + " of " +
        quote_path(recording.string()) + " shows where the camera is: expected one with the fixed board '" +
        board + "'");
  const OverlayMap shown = overlay_map(map);
  if (!options.stills.empty()) save_stills(options.stills, *last, map, shown, plans);
  if (!pictures) return;
  add_motions(film, *last, shown, plans);
  film.finish();
}

}  // namespace clearway
