#include <cmath>

#include "apps/calibrate/calibrations.hpp"
#include "apps/console/parse.hpp"
#include "apps/fusion/painter.hpp"
#include "datasets/descriptions/setup_blocks.hpp"
#include "tracking/calibration/calibrate_board.hpp"

namespace clearway {

namespace {

/// Places are relative to one of the tags, of which none can be told.
std::string place_sigma(const TagChange& tag) {
  return tag.place_sigma > 0.0 ? " +- " + significant(1e3 * tag.place_sigma, 2) : "";
}

}  // namespace

CalibrationReport report_board(const CalibrateOptions& options, const Setup& setup,
                               const SearchedImages& images) {
  const Camera camera = known_camera(setup, images);
  const BoardSetup& board = seen_board(setup, images, options.body);
  const ChosenViews chosen = choose_views(images, board);
  const TrackingOptions how = tracking_options(setup);
  BoardCalibrationOptions demands;
  demands.edge_bias = how.pose.edge_bias;
  demands.pixel_noise = how.pose.pixel_noise;
  const BoardCalibration found = calibrate_board(camera, tag_body(board), chosen.views, demands);
  CalibrationReport report;
  report.refusal = found.refusal;
  if (chosen.views.size() < demands.least_views && !report.refusal.empty())
    report.refusal += chosen.left_out();
  report.rows = {{"board", board.name},
                 {"images", grouped(chosen.seen) + " show it; " + grouped(found.views) + " used, " +
                                grouped(chosen.moving) + " moving, " + grouped(chosen.alike) + " alike"}};
  if (found.tags.empty()) return report;
  report.rows.insert(
      report.rows.end(),
      {{"residuals", significant(found.rms_px, 3) + " px rms"},
       {"distances", significant(found.places_scale, 5) + " of what is stated, +- " +
                         significant(found.scale_tolerance / 5.0, 2) + ", if most sizes are as stated"}});
  BoardSetup measured = board;
  std::size_t wrong = 0, misplaced = 0;
  for (const TagChange& tag : found.tags) {
    const double size = found.board.tags.at(tag.id).size;
    std::string text = significant(1e3 * size, 5) + " +- " + significant(1e3 * size * tag.size_sigma, 2) +
                       " mm, moved by " + significant(1e3 * tag.moved, 3) + place_sigma(tag) + " mm and " +
                       significant(180.0 / M_PI * tag.turned, 2) + " degrees";
    if (found.is_scale_contradicted)
      text += "; its size is " + significant(tag.size_ratio, 4) + " of what is stated by most sizes, " +
              significant(tag.size_ratio / found.places_scale, 4) + " by the distances";
    else if (tag.is_size_wrong)
      text += "; ITS SIZE IS NOT AS STATED: " + significant(1e3 * size / tag.size_ratio, 5) + " mm";
    if (tag.is_place_wrong) text += "; ITS PLACE IS NOT AS STATED";
    if (tag.is_turn_wrong) text += "; IT IS NOT TURNED AS STATED";
    wrong += tag.is_size_wrong ? 1 : 0;
    misplaced += tag.is_place_wrong || tag.is_turn_wrong ? 1 : 0;
    report.rows.push_back({"tag " + std::to_string(tag.id), text});
  }
  report.figures = {{"rms_px", found.rms_px},
                    {"place_sigma_m", found.board.errors.place},
                    {"size_sigma", found.board.errors.size},
                    {"places_scale", found.places_scale},
                    {"places_scale_tolerance", found.scale_tolerance},
                    {"wrong_sizes", static_cast<double>(wrong)},
                    {"wrong_places", static_cast<double>(misplaced)},
                    {"views", static_cast<double>(found.views)}};
  for (const TagChange& tag : found.tags)
    report.figures.push_back({"size_ratio_" + std::to_string(tag.id), tag.size_ratio});
  if (!report.refusal.empty()) return report;
  for (TagSetup& tag : measured.tags) {
    tag.size = found.board.tags.at(tag.id).size;
    tag.board_from_tag = found.board.tags.at(tag.id).body_from_tag;
  }
  const TagErrors& e = found.board.errors;
  measured.errors = {e.scale, e.size, e.place, e.turn};
  std::vector<BoardSetup> boards = setup.boards;
  for (BoardSetup& one : boards)
    if (one.name == measured.name) one = measured;
  report.blocks = {boards_block(boards)};
  report.next =
      "Put this block into the setup, in place of its `boards`. All lengths hold as well as the "
      "stated sizes of most tags: measure one with a calliper.";
  return report;
}

}  // namespace clearway
