#include "apps/overlay/replay_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
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
#include "apps/overlay/overlay_scene.hpp"
#include "apps/track/image_poses.hpp"
#include "datasets/pictures/video.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/atomic_folder.hpp"
#include "mapping/system/parallel.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/planned_motion.hpp"

namespace clearway {
namespace {

bool is_still(const std::filesystem::path& relative) {
  const std::string name = relative.string();
  return name.find('/') == std::string::npos &&
         (name.ends_with("-start.png") || name.ends_with("-goal.png") || name.ends_with("-tightest.png") ||
          name.ends_with("-to_paint.png") || name == "painted.png");
}

std::string millimetres(double metres) { return significant(1000.0 * metres, 3) + " mm"; }

std::string to_tenths(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", seconds);
  return text;
}

/// An image and where its camera was.
struct View {
  cv::Mat image;
  Camera camera;
  Eigen::Isometry3d camera_from_map = Eigen::Isometry3d::Identity();
};

/// The view of an image whose camera's pose passes the setup's acceptance.
std::optional<View> view_of(const ImageFrame& frame, const ImagePoses& poses, const Setup& setup,
                            const cv::Mat& image) {
  const ImagePose* camera = poses.find("camera", "camera", "map");
  if (!poses.refusal.empty() || camera == nullptr || !camera->is_accepted()) return std::nullopt;
  return View{image, camera_of(setup, frame), camera->pose->pose.inverse()};
}

/// The paint as it was at some time, over what the sensors saw in the end.
class GrowingPaint {
 public:
  explicit GrowingPaint(const Snapshot& map) : final_(map), shown_(overlay_map(map)), paint_(options(map)) {
    for (const PaintedVolume& volume : map.volumes()) paint_.add_volume(volume.label, volume.critical_parts);
    next_.resize(map.volumes().size(), 0);
    map.visit_leaves([&](const Voxel& leaf) {
      if (leaf.state == VoxelState::conflict) conflicts_.push_back(leaf);
    });
    show();
  }

  /// @param time seconds since the recording's start, rising
  const OverlayMap& at(double time) {
    bool is_new = false;
    for (std::size_t v = 0; v < next_.size(); ++v) {
      const PaintedVolume& volume = final_.volumes()[v];
      for (; next_[v] < volume.spheres.size() && volume.times[next_[v]] <= time; ++next_[v]) {
        paint_.paint(static_cast<int>(v), volume.spheres[next_[v]], volume.times[next_[v]]);
        is_new = true;
      }
    }
    if (is_new) show();
    return shown_;
  }

  std::size_t balls() const {
    std::size_t count = 0;
    for (const std::size_t next : next_) count += next;
    return count;
  }

 private:
  static MapOptions options(const Snapshot& map) {
    MapOptions options;
    options.resolution = map.resolution();
    return options;
  }

  void show() {
    const Snapshot painted = paint_.snapshot();
    shown_.volumes = overlay_map(painted).volumes;
    PageVoxels met{"conflict", painted.resolution()};
    for (const Voxel& leaf : conflicts_) {
      if (painted.state(leaf.center) != VoxelState::painted) continue;
      met.add(leaf.center, leaf.size);
    }
    shown_.conflicts = mesh_of(exposed_faces(met), met.size);
  }

  const Snapshot& final_;
  OverlayMap shown_;
  FreeSpaceMap paint_;
  std::vector<Voxel> conflicts_;
  std::vector<std::size_t> next_;  ///< ball of each volume
};

/// How a solved plan moves, and how near it comes to things.
struct DrawnMotion {
  std::vector<Configuration> positions;
  std::vector<std::size_t> legs{};  ///< of each of them; empty: nothing rides on the robot
  double period = 0.0;              ///< s between two of them
  OverlayPath path;                 ///< of some of them
  std::size_t tightest = 0;
  double least_clearance = 0.0;
};

void add_timed(const Trajectory& trajectory, DrawnMotion& motion) {
  for (const TrajectoryPoint& point : trajectory.points) motion.positions.push_back(point.position);
  motion.period = trajectory.sampling_period;
}

/// Leg by leg where loads change from one to the next.
void add_timed_legs(const Robot& robot, const Plan& plan, DrawnMotion& motion) {
  const std::vector<Trajectory> legs = leg_trajectories(robot, plan);
  for (std::size_t leg = 0; leg < legs.size(); ++leg) {
    add_timed(legs[leg], motion);
    motion.legs.resize(motion.positions.size(), leg);
  }
}

/// How far the robot is from what is blocked, with what it carries on the leg.
class LegClearance {
 public:
  explicit LegClearance(const ReplayPlan& entry) : entry_(entry) {}

  double at(const Configuration& q, std::size_t leg) {
    if (entry_.plan.loads.empty()) return entry_.space->clearance(q);
    auto& space = spaces_[leg];
    const ConfigurationSpace& bare = *entry_.space;
    if (!space)
      space = std::make_unique<ConfigurationSpace>(
          robot_of_leg(bare.robot(), entry_.plan.loads, static_cast<int>(leg)), bare.map(),
          Policies{.parts = bare.policies(), .other = Policy::not_occupied}, bare.options());
    return space->clearance(q);
  }

 private:
  const ReplayPlan& entry_;
  std::map<std::size_t, std::unique_ptr<ConfigurationSpace>> spaces_;
};

DrawnMotion drawn_motion(const ReplayPlan& entry) {
  const Robot& robot = entry.space->robot();
  DrawnMotion motion;
  try {
    if (entry.plan.loads.empty())
      add_timed(trajectory_of(robot, entry.plan), motion);
    else
      add_timed_legs(robot, entry.plan, motion);
  } catch (const std::invalid_argument&) {  // too long to be given time
    motion.positions = entry.plan.waypoints();
    motion.legs.clear();
    motion.period = 0.1;
  }
  LegClearance clearances(entry);
  constexpr std::size_t shown = 240;
  const std::size_t last = motion.positions.size() - 1, pieces = std::min(last, shown);
  for (std::size_t i = 0; i <= pieces; ++i) {
    const std::size_t at = pieces == 0 ? 0 : i * last / pieces;
    const double clearance = clearances.at(motion.positions[at], motion.legs.empty() ? 0 : motion.legs[at]) +
                             entry.space->options().padding;  // as plans have it
    motion.path.points.push_back(tip_pose(robot, motion.positions[at]).translation());
    motion.path.clearance.push_back(clearance);
    if (i > 0 && !(clearance < motion.least_clearance)) continue;
    motion.least_clearance = clearance;
    motion.tightest = at;
  }
  return motion;
}

/// Draws plans into one view.
class PlanPictures {
 public:
  PlanPictures(const View& view, const OverlayMap& map) : view_(view), map_(map) {}

  cv::Mat solved(const ReplayPlan& entry, const DrawnMotion& motion, std::size_t at,
                 const std::string& moment) {
    OverlayScene scene = scene_of(entry);
    scene.robot_pose = forward_kinematics(entry.space->robot(), motion.positions[at]);
    scene.path = motion.path;
    if (!motion.legs.empty())
      add_loads(scene, entry, motion.legs[at], scene.robot_pose, OverlayLoad::Holder::hand);
    if (!motion.legs.empty()) add_standing(scene, entry, motion.legs[at]);
    const std::size_t last = motion.positions.size() - 1;
    if (at != 0) show_start(scene, entry, motion.positions.front());
    if (at != last) show_goal(scene, entry, motion.positions.back());
    scene.strip = Strip{entry.query + ", " + entry.plan.planner + ": " + moment, "", "", "", 0.0};
    return draw(scene);
  }

  cv::Mat painted(const Snapshot& map) const {
    OverlayScene scene;
    scene.map = &map_;
    std::size_t balls = 0;
    for (const PaintedVolume& volume : map.volumes()) balls += volume.spheres.size();
    scene.strip = Strip{
        grouped(balls) + " balls painted, " + grouped(map.counts().conflict) + " voxels of them occupied", "",
        "", "", 0.0};
    return draw(scene);
  }

  cv::Mat failed(const ReplayPlan& entry) {
    OverlayScene scene = scene_of(entry);
    show_start(scene, entry, entry.start);
    add_standing(scene, entry, 0);
    if (!entry.plan.goals.empty()) show_goal(scene, entry, entry.plan.goals.back());
    for (const PaintHint& hint : entry.plan.paint) scene.to_paint.push_back(hint.sphere);
    const bool is_refused = entry.plan.status() == PlanStatus::solved;
    scene.strip =
        Strip{entry.query + ", " + entry.plan.planner + ": " +
                  (is_refused ? "refused by the check" : std::string(to_string(entry.plan.status()))),
              is_refused ? entry.plan.validation.first_contact : entry.plan.explanation(),
              PaintAdvice{entry.plan.paint}.sentence(), "", 0.0};
    return draw(scene);
  }

 private:
  /// What rides on a leg, in the hand that is drawn.
  static void add_loads(OverlayScene& scene, const ReplayPlan& entry, std::size_t leg, const LinkPoses& poses,
                        OverlayLoad::Holder holder) {
    const std::vector<Link>& links = entry.space->robot().links;
    for (const LegLoad& load : entry.plan.loads)
      for (std::size_t i = 0; i < links.size() && load.rides_on(static_cast<int>(leg)); ++i)
        if (links[i].name == load.load.link)
          scene.loads.push_back({mesh_of(load.load.shape), poses[i] * load.load.link_from_load, holder});
  }

  /// What is picked, before it is lifted and after it is put down.
  static void add_standing(OverlayScene& scene, const ReplayPlan& entry, std::size_t leg) {
    constexpr int lift = 2, lower = 4;  // as Pick lists its legs
    if (!entry.plan.pick || (leg >= lift && leg <= lower)) return;
    const Pick& pick = *entry.plan.pick;
    scene.loads.push_back({mesh_of(pick.object.shape),
                           leg < lift ? pick.map_from_object : pick.map_from_place,
                           OverlayLoad::Holder::none});
  }

  OverlayScene scene_of(const ReplayPlan& entry) {
    OverlayScene scene;
    scene.map = &map_;
    scene.robot = &surfaces_.try_emplace(entry.space, entry.space->robot()).first->second;
    return scene;
  }

  static void show_start(OverlayScene& scene, const ReplayPlan& entry, const Configuration& q) {
    scene.start_pose = forward_kinematics(entry.space->robot(), q);
    scene.start_tip = tip_pose(entry.space->robot(), q).translation();
    add_loads(scene, entry, 0, scene.start_pose, OverlayLoad::Holder::start);
  }

  static void show_goal(OverlayScene& scene, const ReplayPlan& entry, const Configuration& q) {
    scene.goal_pose = forward_kinematics(entry.space->robot(), q);
    scene.goal_tip = tip_pose(entry.space->robot(), q).translation();
    const std::size_t legs = std::max(entry.plan.goals.size(), entry.plan.legs.size());
    add_loads(scene, entry, legs == 0 ? 0 : legs - 1, scene.goal_pose, OverlayLoad::Holder::goal);
  }

  cv::Mat draw(const OverlayScene& scene) const {
    return draw_overlay(view_.image, view_.camera, view_.camera_from_map, scene, thread_count());
  }

  const View& view_;
  const OverlayMap& map_;
  std::map<const ConfigurationSpace*, RobotSurface> surfaces_;
};

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
    save("tightest", pictures.solved(entry, motion, motion.tightest,
                                     "tightest point, clearance " + millimetres(motion.least_clearance)));
  }
  stills.publish();
}

/// The images of the recording with what was painted so far.
class RecordingPictures {
 public:
  RecordingPictures(const Setup& setup, const Snapshot& map) : setup_(setup), paint_(map) {}

  cv::Mat draw(const View& view, const ImagePoses& poses, double since_start) {
    OverlayScene scene;
    scene.map = &paint_.at(since_start);
    if (setup_.probe) scene.ball = ball_of(poses, since_start);
    scene.strip = strip(since_start);
    return draw_overlay(view.image, view.camera, view.camera_from_map, scene, thread_count());
  }

  /// Of an image whose camera is nobody knows where.
  cv::Mat draw_lost(const cv::Mat& image, const ImagePoses& poses, double since_start) {
    paint_.at(since_start);
    if (setup_.probe) ball_of(poses, since_start);
    cv::Mat picture;
    cv::merge(std::vector<cv::Mat>{image, image, image}, picture);
    draw_strip(picture, strip(since_start));
    return picture;
  }

 private:
  std::optional<OverlayBall> ball_of(const ImagePoses& poses, double since_start) {
    const ImagePose* ball = poses.find("ball", "ball", "map");
    if (ball == nullptr) return std::nullopt;
    if (!ball->is_accepted()) {
      refused_at_ = since_start;
      refusal_ = "Not painted: " + ball->reason;
      cure_ = cure_of(ball->refusal);
    }
    if (!ball->pose || !ball->bound) return std::nullopt;
    return OverlayBall{ball->pose->pose.translation(), setup_.probe->ball_radius, ball->bound->total,
                       ball->is_accepted()};
  }

  Strip strip(double since_start) const {
    Strip strip;
    strip.state = to_tenths(since_start) + ", " + grouped(paint_.balls()) + " balls painted";
    constexpr double held = 1.0;  // s: time to read it
    if (refused_at_ && since_start - *refused_at_ < held) {
      strip.refusal = refusal_;
      strip.cure = cure_;
    }
    return strip;
  }

  const Setup& setup_;
  GrowingPaint paint_;
  std::optional<double> refused_at_;
  std::string refusal_, cure_;
};

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
    throw std::invalid_argument("--overlay and --video-out: none of the " + grouped(fusion.counts.images) +
                                " images of " + quote_path(recording.string()) +
                                " tells where the camera is: expected one with the fixed board '" + board +
                                "'");
  const OverlayMap shown = overlay_map(map);
  if (!options.stills.empty()) save_stills(options.stills, *last, map, shown, plans);
  if (!pictures) return;
  add_motions(film, *last, shown, plans);
  film.finish();
}

}  // namespace clearway
