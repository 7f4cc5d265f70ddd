#include <gtest/gtest.h>

#include "datasets/descriptions/probe_motion.hpp"
#include "datasets/descriptions/scene.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {
namespace shipped_scenes_test {

const std::filesystem::path datasets = std::filesystem::path(CLEARWAY_SOURCE_DIR) / "datasets";

double distance(const SceneShape& shape, const Eigen::Vector3d& map_point) {
  const Eigen::Vector3d p = shape.map_from_shape.inverse() * map_point;
  if (const auto* box = std::get_if<BoxShape>(&shape.geometry))
    return (p.cwiseAbs() - box->size / 2).cwiseMax(0).norm();
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape.geometry))
    return std::hypot(std::max(0.0, std::hypot(p.x(), p.y()) - cylinder->radius),
                      std::max(0.0, std::abs(p.z()) - cylinder->length / 2));
  return p.norm() - std::get<SphereShape>(shape.geometry).radius;
}

TEST(ShippedScenes, EverySetupAndSceneLoads) {
  for (const char* folder : {"setups", "scenes"})
    for (const auto& entry : std::filesystem::directory_iterator(datasets / folder)) {
      if (entry.path().extension() != ".yaml") continue;
      if (folder == std::string("setups"))
        EXPECT_NO_THROW(load_setup(entry.path())) << entry.path();
      else
        EXPECT_NO_THROW(load_scene(entry.path())) << entry.path();
    }
}

TEST(ShippedScenes, TheMiniatureProbeStaysClearOfEverything) {
  const Scene scene = load_scene(datasets / "scenes/miniature_kitchen.yaml");
  const ProbeMotion motion(*scene.stroke, *scene.setup.probe);
  EXPECT_NEAR(scene.setup.probe->painted_radius(), 0.020, 1e-12);
  Eigen::Vector3d last = motion.at(0).map_ball;
  for (double time = 0; time <= motion.duration(); time += 1 / scene.camera->rate_hz) {
    const auto state = motion.at(time);
    EXPECT_LE((state.map_ball - last).norm(), 0.003);
    last = state.map_ball;
    for (const auto& shape : scene.shapes)
      EXPECT_GE(distance(shape, state.map_ball) - scene.setup.probe->ball_radius, 0.003)
          << shape.name << " at " << time << " s";
  }
  EXPECT_LE(motion.duration() * scene.camera->rate_hz + 1, 121);
}

TEST(ShippedScenes, TheBookshelfProbeStaysClearOfWhatTheKinectSaw) {
  const Scene scene = load_scene(datasets / "scenes/bookshelf.yaml");
  const ProbeMotion motion(*scene.stroke, *scene.setup.probe);
  RecordingReader reader(scene.includes.at(0).recording);
  size_t clouds = 0;
  while (const auto frame = reader.next()) {
    const auto* cloud = std::get_if<CloudFrame>(&frame->content);
    if (!cloud) continue;
    ++clouds;
    const Eigen::Isometry3d map_from_sensor =
        scene.includes[0].world_from_map.inverse() * cloud->world_from_sensor;
    for (size_t i = 0; i < cloud->points.size(); i += 37) {
      const Eigen::Vector3d point = map_from_sensor * cloud->points[i].cast<double>();
      for (double time = 0; time <= motion.duration(); time += 0.1)
        EXPECT_GT((point - motion.at(time).map_ball).norm(), scene.setup.probe->ball_radius + 0.1);
    }
  }
  EXPECT_EQ(clouds, 1u);
}

}  // namespace shipped_scenes_test
}  // namespace clearway
