#include "apps/calibrate/board_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/fusion/emptiness.hpp"
#include "apps/fusion/open_frames.hpp"
#include "apps/fusion/painter.hpp"
#include "apps/fusion/tag_search.hpp"
#include "mapping/system/parallel.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// The mean distance of the corners that two images share; infinity when they share none.
double mean_motion(const std::vector<TagDetection>& a, const std::vector<TagDetection>& b) {
  double sum = 0.0;
  int corners = 0;
  for (const TagDetection& tag : a) {
    const auto other =
        std::find_if(b.begin(), b.end(), [&](const TagDetection& one) { return one.id == tag.id; });
    if (other == b.end()) continue;
    for (std::size_t i = 0; i < 4; ++i, ++corners) sum += (tag.corners[i] - other->corners[i]).norm();
  }
  return corners > 0 ? sum / corners : std::numeric_limits<double>::infinity();
}

std::vector<TagDetection> of_board(const std::vector<TagDetection>& tags, const BoardSetup& board) {
  std::vector<TagDetection> own;
  for (const TagDetection& tag : tags)
    if (std::any_of(board.tags.begin(), board.tags.end(),
                    [&](const TagSetup& one) { return one.id == tag.id; }))
      own.push_back(tag);
  return own;
}

std::set<int> ids_in(const SearchedImages& images) {
  std::set<int> ids;
  for (const SearchedImage& image : images.images)
    for (const TagDetection& tag : image.tags) ids.insert(tag.id);
  return ids;
}

/// Images of the size that most images with tags have stay; of two that are as frequent, that of the first
/// image.
void keep_most_frequent_size(SearchedImages& found) {
  std::map<std::pair<int, int>, std::size_t> counts;
  const bool is_any_tag = std::any_of(found.images.begin(), found.images.end(),
                                      [](const SearchedImage& image) { return !image.tags.empty(); });
  for (const SearchedImage& image : found.images)
    counts[{image.width, image.height}] += is_any_tag && image.tags.empty() ? 0 : 1;
  std::size_t most = 0;
  for (const SearchedImage& image : found.images)
    if (const std::size_t count = counts[{image.width, image.height}]; count > most) {
      most = count;
      found.width = image.width;
      found.height = image.height;
    }
  found.other_size = std::erase_if(found.images, [&](const SearchedImage& image) {
    return image.width != found.width || image.height != found.height;
  });
  for (const SearchedImage& image : found.images)
    if (!found.intrinsics && image.intrinsics.width > 0) found.intrinsics = image.intrinsics;
}

}  // namespace

SearchedImages search_images(const std::filesystem::path& source, const Setup& setup, int threads,
                             Console& console) {
  SearchedImages found;
  const std::unique_ptr<FrameSource> frames = open_frames(source, setup.source);
  const std::size_t workers =
      threads > 0 ? static_cast<std::size_t>(threads) : std::min<std::size_t>(thread_count(), 8);
  TagSearch search(*frames, tracking_options(setup).detector, workers);
  const auto progress = console.bar("searching for tags");
  std::size_t number = 0, tags = 0;
  while (auto searched = search.next()) {
    progress(frames->progress());
    const auto* image = std::get_if<ImageFrame>(&searched->frame.content);
    if (image == nullptr) continue;
    ++number;
    tags += searched->tags.size();
    const std::string& file = searched->frame.file;
    found.images.push_back({searched->frame.time, file.empty() ? "image " + std::to_string(number) : file,
                            std::move(searched->tags), image->image.width, image->image.height,
                            image->intrinsics});
  }
  progress(1.0);
  for (const std::string& warning : frames->warnings()) console.warn("warning: " + warning);
  found.damage = frames->damage();
  if (found.images.empty() && found.damage) return found;
  const std::string name = quote_path(source.string());
  if (found.images.empty()) throw std::invalid_argument(name + " holds no image");
  if (tags == 0)
    throw std::invalid_argument("no " + setup.detector.family + " tag is seen in the " +
                                counted(number, "image") + " of " + name);
  keep_most_frequent_size(found);
  if (found.other_size > 0)
    console.warn("warning: " + grouped(found.other_size) + " of " + counted(number, "image") + " of " + name +
                 " have another size than most, " + std::to_string(found.width) + " x " +
                 std::to_string(found.height) + " pixels: they are left out");
  return found;
}

Camera known_camera(const Setup& setup, const SearchedImages& images) {
  auto intrinsics = setup.camera ? setup.camera : images.intrinsics;
  if (!intrinsics)
    throw std::invalid_argument(
        "neither setup nor source has the camera: expected `camera` in the setup (see "
        "clearway calibrate camera)");
  if (images.intrinsics && images.intrinsics->is_rectified) intrinsics->is_rectified = true;
  const Camera camera = tracking_camera(*intrinsics, setup.errors.camera);
  camera.validate();
  if (camera.width != images.width || camera.height != images.height)
    throw std::invalid_argument("the images have " + std::to_string(images.width) + " x " +
                                std::to_string(images.height) + " pixels, expected the camera's " +
                                std::to_string(camera.width) + " x " + std::to_string(camera.height));
  return camera;
}

SurePoses::SurePoses(const Setup& setup, const SearchedImages& images)
    : camera_(known_camera(setup, images)), how_(tracking_options(setup)) {}

std::optional<BodyPose> SurePoses::of(const BoardSetup& board, const SearchedImage& image) const {
  auto pose = estimate_body_pose(tag_body(board), image.tags, camera_, how_.pose);
  const bool is_sure = pose && is_explained(*pose, how_.acceptance) &&
                       pose->ambiguity_ratio >= how_.acceptance.min_ambiguity_ratio &&
                       pose->separation >= how_.acceptance.min_separation;
  return is_sure ? pose : std::nullopt;
}

std::string seen_instead(const Setup& setup, const SearchedImages& images, const BoardSetup& wanted) {
  std::set<int> unknown = ids_in(images);
  std::string list;
  for (const BoardSetup& board : setup.boards) {
    for (const TagSetup& tag : board.tags) unknown.erase(tag.id);
    const auto count = std::count_if(images.images.begin(), images.images.end(),
                                     [&](const auto& image) { return !of_board(image.tags, board).empty(); });
    if (count > 0 && board.name != wanted.name)
      list += (list.empty() ? "" : ", ") + ("board " + quote(board.name)) + " in " +
              counted(static_cast<std::size_t>(count), "image");
  }
  if (!unknown.empty()) list += (list.empty() ? "" : ", ") + ("tags of no board, " + list_of_ids(unknown));
  return list.empty() ? "" : "; seen instead: " + list;
}

const BoardSetup& seen_board(const Setup& setup, const SearchedImages& images, const std::string& name) {
  if (!name.empty()) {
    if (const BoardSetup* board = setup.board(name)) return *board;
    throw std::invalid_argument("--body: the setup has no board '" + name + "', expected the name of one");
  }
  const BoardSetup* best = nullptr;
  std::size_t most = 0;
  for (const BoardSetup& board : setup.boards) {
    std::size_t tags = 0;
    for (const SearchedImage& image : images.images) tags += of_board(image.tags, board).size();
    if (tags > most) {
      best = &board;
      most = tags;
    }
  }
  if (best != nullptr) return *best;
  throw std::invalid_argument(
      "no tag in the images is on a board of the setup: expected its `boards` to name "
      "the tags that are seen (ids " +
      list_of_ids(ids_in(images)) + ")");
}

std::string ChosenViews::left_out() const {
  if (moving + alike == 0) return "";
  const auto verb = [](std::size_t count, const char* one, const char* many) {
    return grouped(count) + (count == 1 ? one : many);
  };
  return "; of " + grouped(seen) + " that show the board " + verb(alike, " is", " are") +
         " like others and " + verb(moving, " was", " were") +
         " taken while it moved: show it elsewhere and otherwise tilted in each" +
         (moving > 0 ? ", and hold it still" : "");
}

ChosenViews choose_views(const SearchedImages& images, const BoardSetup& board, std::size_t most,
                         double most_motion) {
  constexpr double stream_gap = 0.3, least_news = 0.02;  // s; share of the image's width
  ChosenViews chosen;
  const std::size_t needed = std::min<std::size_t>(2, board.tags.size());
  std::vector<std::pair<std::size_t, std::vector<TagDetection>>> still;
  for (std::size_t i = 0; i < images.images.size(); ++i) {
    std::vector<TagDetection> tags = of_board(images.images[i].tags, board);
    if (tags.size() < needed) continue;
    ++chosen.seen;
    double motion = 0.0;
    for (const std::size_t other : {i - 1, i + 1}) {
      if (other >= images.images.size()) continue;
      if (std::abs(images.images[other].time - images.images[i].time) > stream_gap) continue;
      const double moved = mean_motion(tags, images.images[other].tags);
      if (std::isfinite(moved)) motion = std::max(motion, moved);
    }
    if (motion > most_motion)
      ++chosen.moving;
    else
      still.emplace_back(i, std::move(tags));
  }
  // Farthest first (Gonzalez 1985): each next one is the one least like those that are chosen.
  std::vector<double> news(still.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> picked;
  while (picked.size() < most && picked.size() < still.size()) {
    const auto next = std::max_element(news.begin(), news.end());
    if (*next < least_news * images.width) break;
    const std::size_t at = static_cast<std::size_t>(next - news.begin());
    picked.push_back(at);
    for (std::size_t i = 0; i < still.size(); ++i)
      news[i] = i == at ? -1.0 : std::min(news[i], mean_motion(still[i].second, still[at].second));
  }
  chosen.alike = still.size() - picked.size();
  std::sort(picked.begin(), picked.end());
  for (const std::size_t at : picked)
    chosen.views.push_back({images.images[still[at].first].name, still[at].second});
  return chosen;
}

}  // namespace clearway
