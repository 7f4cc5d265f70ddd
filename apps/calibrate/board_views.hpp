#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/console/console.hpp"
#include "datasets/descriptions/setup.hpp"
#include "datasets/sources/recording.hpp"
#include "tracking/calibration/bundle.hpp"
#include "tracking/tracking_session.hpp"

namespace clearway {

/// One image of a source, and the tags in it that are seen once.
struct SearchedImage {
  double time = 0.0;  ///< s
  std::string name;   ///< the file's, else "image N"
  std::vector<TagDetection> tags;
  int width = 0, height = 0;
  CameraIntrinsics intrinsics{};  ///< by the source; width 0: it has none
};

/// All images of a source.
struct SearchedImages {
  int width = 0, height = 0;                   ///< of most of them
  std::optional<CameraIntrinsics> intrinsics;  ///< by the source, where it has any
  std::vector<SearchedImage> images;
  std::size_t other_size = 0;  ///< images of another size, left out
  std::optional<std::string> damage;
};

/// Reads a source and searches its images for tags; those of another size than most are left out, with a
/// warning. @throws std::invalid_argument as open_frames does, and when there is no image or no tag in any
SearchedImages search_images(const std::filesystem::path& source, const Setup& setup, int threads,
                             Console& console);

/// The camera of the setup, else of the source, with its errors.
/// @throws std::invalid_argument when neither gives it, or its images are of another size
Camera known_camera(const Setup& setup, const SearchedImages& images);

/// The board whose tags are in most images, or that of the given name.
/// @throws std::invalid_argument when there is none of that name, or none is seen
const BoardSetup& seen_board(const Setup& setup, const SearchedImages& images, const std::string& name);

/// A clause about the other boards that are seen, and about tags of none; "": there are none.
std::string seen_instead(const Setup& setup, const SearchedImages& images, const BoardSetup& wanted);

/// Poses of boards in images, as far as nothing else explains them.
class SurePoses {
 public:
  /// @throws std::invalid_argument as known_camera does
  SurePoses(const Setup& setup, const SearchedImages& images);

  /// camera_from_board; empty where its tags are not seen, do not fit, or fit another pose as well.
  std::optional<BodyPose> of(const BoardSetup& board, const SearchedImage& image) const;

 private:
  Camera camera_;
  TrackingOptions how_;
};

/// Views of one board.
struct ChosenViews {
  std::vector<BoardView> views;
  std::size_t seen = 0;    ///< images that show two of its tags or more, or all that it has
  std::size_t moving = 0;  ///< of these, taken while the board moved
  std::size_t alike = 0;   ///< of these, as another one that was chosen

  /// "; of 20 images that show the board 19 are like others and 0 were taken while it moved", behind a
  /// refusal that counts only the others; empty where none is left out.
  std::string left_out() const;
};

/// Images of a board that add something new: at most `most` of them. Of a stream (images less than 0.3 s
/// apart) those in which the corners moved by less than `most_motion` pixels an image, on the mean.
ChosenViews choose_views(const SearchedImages& images, const BoardSetup& board, std::size_t most = 60,
                         double most_motion = 2.0);

}  // namespace clearway
