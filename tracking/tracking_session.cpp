#include "tracking/tracking_session.hpp"

#include <opencv2/core.hpp>
#include <string>
#include <utility>

namespace clearway {

TrackingSession::TrackingSession(const TrackingSetup& setup, const TrackingOptions& options)
    : camera_(setup.camera),
      detector_(options.detector),
      probe_(setup.camera, setup.base, setup.probe, setup.budget, options.acceptance, options.pose) {}

bool TrackingSession::takes(const cv::Mat& gray) const {
  return gray.cols == camera_.width && gray.rows == camera_.height &&
         is_detectable(gray, detector_.options().decimate);
}

TrackedImage TrackingSession::step(const cv::Mat& gray, double time) {
  return step(gray, takes(gray) ? detector_.detect(gray) : std::vector<TagDetection>(), time);
}

TrackedImage TrackingSession::step(const cv::Mat& gray, std::vector<TagDetection> detections, double time) {
  if (!takes(gray))
    return {{},
            probe_.refuse_image("the image has " + std::to_string(gray.cols) + " x " +
                                    std::to_string(gray.rows) + " pixels of type " +
                                    cv::typeToString(gray.type()) + ", expected 8-bit grey, " +
                                    std::to_string(camera_.width) + " x " + std::to_string(camera_.height),
                                time)};
  TrackedImage image{std::move(detections), {}};
  image.sample = probe_.sample(image.detections, time);
  return image;
}

}  // namespace clearway
