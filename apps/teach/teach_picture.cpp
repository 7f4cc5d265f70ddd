#include "apps/teach/teach_picture.hpp"

#include <algorithm>
#include <cstdio>
#include <opencv2/core.hpp>

#include "apps/fusion/painter.hpp"
#include "apps/overlay/strip.hpp"
#include "apps/teach/teach_keys.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double refusal_shown_for = 3.0;  ///< s that a refused event stays in the strip
constexpr double sensed_every = 1.0;       ///< s between two pictures of conflicts and what sensors saw

/// Whether `now` is `before` with spheres added at the ends.
bool goes_on(const std::vector<PaintedVolume>& before, const std::vector<PaintedVolume>& now) {
  if (before.size() > now.size()) return false;
  for (std::size_t v = 0; v < before.size(); ++v) {
    const auto &old = before[v].spheres, &all = now[v].spheres;
    if (before[v].label != now[v].label || old.size() > all.size()) return false;
    const auto same = [](const Sphere& a, const Sphere& b) {
      return a.center == b.center && a.radius == b.radius;
    };
    if (!std::equal(old.begin(), old.end(), all.begin(), same)) return false;
  }
  return true;
}

}  // namespace

TeachView TeachViewer::view(const SeenImage& image, const ImageFrame& frame) {
  TeachView view;
  view.image = cv::Mat(frame.image.height, frame.image.width, CV_8UC1,
                       const_cast<std::uint8_t*>(frame.image.pixels.data()))
                   .clone();
  view.camera = camera_of(setup_, frame);
  view.since_start = image.since_start;
  view.taken = image.read;
  view.state = session_.state();
  for (const PaintedVolume& volume : map_.volumes()) view.balls += volume.spheres.size();
  view.is_led = image.map_from_gripper && session_.robot() != nullptr;
  view.resolution = map_.options().resolution;
  view.offer = {.probe = setup_.probe.has_value(),
                .objects = session_.has_objects(),
                .place = session_.wants_place(),
                .load = !session_.held_loads().empty(),
                .robot = session_.robot() != nullptr && session_.robot()->q().size() > 0,
                .stroke = session_.has_strokes()};
  add_camera(image, view);
  add_map(view);
  add_robot(view);
  add_sentences(image, view);
  add_loads(view);
  return view;
}

/// Where the camera is, by the base board in its image; a fixed camera stays where it was seen last.
void TeachViewer::add_camera(const SeenImage& image, TeachView& view) {
  const BoardSetup& board = fixed_board(setup_, "teaching");
  const PaintingSample* sample = image.sample;
  const auto base = sample != nullptr ? sample->base
                                      : estimate_body_pose(tag_body(board), image.tags, view.camera,
                                                           tracking_options(setup_).pose);
  if (base)
    camera_from_map_ = base->camera_from_body.pose * board.map_from_board->inverse();
  else if (!setup_.acceptance.fixed_camera)
    camera_from_map_.reset();
  view.camera_from_map = camera_from_map_;
  if (sample != nullptr && sample->base && sample->probe)
    view.ball = OverlayBall{*board.map_from_board * sample->sphere.center, setup_.probe->ball_radius,
                            sample->bound.total, sample->accepted};
}

void TeachViewer::add_map(TeachView& view) {
  const auto& volumes = map_.volumes();
  const std::size_t active = static_cast<std::size_t>(session_.brush().volume);
  if (active < volumes.size()) view.volume = volumes[active].label;
  if (session_.map_version() != painted_version_)
    view.volumes = std::make_shared<std::vector<PaintedVolume>>(volumes);
  painted_version_ = session_.map_version();
  add_sensed(view);
}

/// Conflicts come and go with paint as with scans. What ends a stroke or undoes it is drawn at once.
void TeachViewer::add_sensed(TeachView& view) {
  const std::size_t version = session_.map_version();
  if (version == sensed_version_) return;
  const std::size_t by_hand = version - counts_.scans_inserted;
  const bool is_stroke = session_.brush().use != Brush::Use::none;
  const bool is_urgent = by_hand != sensed_by_hand_ && !is_stroke;
  if (!is_urgent && view.since_start < sensed_at_ + sensed_every) return;
  sensed_version_ = version;
  sensed_by_hand_ = by_hand;
  sensed_at_ = view.since_start;
  view.sensed = map_.snapshot();
}

void TeachViewer::add_robot(TeachView& view) {
  const VirtualRobot* robot = session_.robot();
  if (robot == nullptr) return;
  if (robot != drawn_) {
    auto drawn = std::make_shared<Robot>(robot->robot());
    drawn->critical_parts = robot->painted_parts();
    robot_ = std::move(drawn);
  }
  drawn_ = robot;
  view.robot = robot_;
  const auto place = [&](const Configuration& q, LinkPoses& poses) {
    if (q.size() == static_cast<Eigen::Index>(robot_->dof())) poses = forward_kinematics(*robot_, q);
  };
  place(session_.shown_configuration(), view.robot_pose);
  if (session_.start()) {
    place(session_.start()->q, view.start_pose);
    view.start_tip = tip_pose(*robot_, session_.start()->q).translation();
  }
  if (session_.goal()) {
    place(session_.goal()->q, view.goal_pose);
    view.goal_tip = tip_pose(*robot_, session_.goal()->q).translation();
  }
  const TaughtPlan* plan = session_.last_plan();
  if (plan == nullptr) return;
  if (!plan->plan.is_proved())
    for (const PaintHint& hint : plan->plan.paint) view.to_paint.push_back(hint.sphere);
  if (&plan->plan != planned_)
    path_ = std::make_shared<OverlayPath>(OverlayPath{plan->tip_path, plan->tip_clearance});
  planned_ = &plan->plan;
  if (!path_->points.empty()) view.path = path_;
}

/// In the hand what it holds; in the ghosts' what rides on the first leg, and on the last.
void TeachViewer::add_loads(TeachView& view) {
  using Holder = OverlayLoad::Holder;
  if (!view.robot) return;
  const auto add = [&](const LinkPoses& poses, const std::vector<Load>& held, Holder holder) {
    if (poses.empty()) return;
    for (const Load& load : held)
      for (std::size_t i = 0; i < view.robot->links.size(); ++i)
        if (view.robot->links[i].name == load.link)
          view.loads.push_back({mesh_of(load.shape), poses[i] * load.link_from_load, holder,
                                holder == Holder::hand && view.is_led && !view.warning.empty()});
  };
  add(view.robot_pose, session_.shown_loads(), Holder::hand);
  if (!session_.shown_loads().empty()) view.held = names_of(session_.shown_loads());
  const std::vector<TaughtPlace> goals = session_.goals();
  if (session_.start())
    add(view.start_pose, goals.empty() ? session_.start()->held : goals.front().held, Holder::start);
  if (session_.goal()) add(view.goal_pose, session_.goal()->held, Holder::goal);
  for (const auto& [load, map_from_object] : session_.standing_objects())
    view.loads.push_back({mesh_of(load->shape), map_from_object, Holder::none, false});
}

void TeachViewer::add_sentences(const SeenImage& image, TeachView& view) {
  if (view.state != TeachState::playing) view.warning = session_.warning();
  const bool marks = view.state == TeachState::marking;
  const bool uses_ball = session_.brush().use != Brush::Use::none || marks;
  if (uses_ball && image.sample != nullptr && !image.sample->accepted) {
    const bool paints = session_.brush().use == Brush::Use::paints;
    view.refusal = (marks    ? "Not marked: "
                    : paints ? "Not painted: "
                             : "Not erased: ") +
                   image.sample->reason;
    view.cure = cure_of(to_string(image.sample->refusal));
    return;
  }
  if (!view.camera_from_map) {
    view.refusal =
        "Nothing is drawn: the base board " + quote(fixed_board(setup_, "teaching").name) + " is not seen";
    view.cure = cure_of(to_string(Refusal::base_not_seen));
  }
  if (session_.events().empty()) return;
  const TaughtEvent& last = session_.events().back();
  if (image.since_start > last.event.time + refusal_shown_for) return;
  const std::string action(to_string(last.event.action));
  std::string sentence;
  if (!last.refusal.empty()) sentence = action + " refused: " + last.refusal;
  const bool is_told = last.event.action == TeachAction::paint_off ||
                       last.event.action == TeachAction::branch ||
                       last.event.action == TeachAction::undo_stroke;
  if (is_told && last.refusal.empty() && !last.remark.empty()) sentence = action + ": " + last.remark;
  if (sentence.empty()) return;
  view.refusal = sentence;
  view.cure.clear();
}

std::string state_line(const TeachView& view) {
  char time[32];
  std::snprintf(time, sizeof time, "%.1f s", view.since_start);
  std::string line = std::string(time) + ", " + std::string(to_string(view.state));
  if (!view.volume.empty()) line += ", volume " + view.volume + ", " + counted(view.balls, "ball");
  if (!view.held.empty()) line += ", holds " + view.held;
  return line;
}

/// Paint is drawn from spheres of its own: the map of a session is not to be copied at every image.
void TeachPainter::take_paint(const TeachView& view) {
  if (!view.volumes) return;
  if (!paint_ || !goes_on(painted_, *view.volumes)) {
    MapOptions options;
    options.resolution = view.resolution;
    paint_.emplace(options);
    painted_.clear();
  }
  for (std::size_t v = 0; v < view.volumes->size(); ++v) {
    const PaintedVolume& volume = (*view.volumes)[v];
    if (v == painted_.size()) {
      paint_->add_volume(volume.label, volume.critical_parts);
      painted_.push_back({volume.label, volume.critical_parts});
    }
    for (std::size_t i = painted_[v].spheres.size(); i < volume.spheres.size(); ++i)
      paint_->paint(static_cast<int>(v), volume.spheres[i], 0.0);
    painted_[v].spheres = volume.spheres;
  }
  shown_.volumes = overlay_map(paint_->snapshot()).volumes;
}

cv::Mat TeachPainter::draw(const TeachView& view) {
  if (view.sensed) {
    OverlayMap sensed = overlay_map(*view.sensed);
    shown_.conflicts = std::move(sensed.conflicts);
    shown_.occupied = std::move(sensed.occupied);
  }
  take_paint(view);
  if (view.robot != robot_) {
    surface_.reset();
    if (view.robot) surface_.emplace(*view.robot);
    robot_ = view.robot;
  }
  const std::string refusal = view.refusal.empty() ? view.warning : view.refusal;
  const std::string keys =
      keys_of(view.state, view.offer) + (view.more_keys.empty() ? "" : ", " + view.more_keys);
  const Strip strip{state_line(view), refusal, view.cure, keys, 0.0};
  if (!view.camera_from_map) {
    cv::Mat picture;
    cv::merge(std::vector<cv::Mat>{view.image, view.image, view.image}, picture);
    draw_strip(picture, strip);
    return picture;
  }
  OverlayScene scene;
  scene.map = &shown_;
  scene.robot = surface_ ? &*surface_ : nullptr;
  scene.robot_pose = view.robot_pose;
  scene.start_pose = view.start_pose;
  scene.goal_pose = view.goal_pose;
  scene.start_tip = view.start_tip;
  scene.goal_tip = view.goal_tip;
  scene.loads = view.loads;
  if (view.path) scene.path = *view.path;
  scene.to_paint = view.to_paint;
  const bool is_choosing = view.state == TeachState::ready || view.state == TeachState::selecting;
  const bool has_plan = view.state == TeachState::planned || view.state == TeachState::approved;
  const bool is_refused = has_plan && !view.warning.empty();  // where another goal would be
  if (view.is_led && (is_choosing || is_refused)) {
    for (const PaintedVolume& volume : painted_)
      for (const Sphere& sphere : volume.spheres) scene.dots.push_back(sphere.center);
    scene.is_outside = !view.warning.empty();
  }
  scene.ball = view.ball;
  scene.strip = strip;
  return draw_overlay(view.image, view.camera, *view.camera_from_map, scene, threads_);
}

}  // namespace clearway
