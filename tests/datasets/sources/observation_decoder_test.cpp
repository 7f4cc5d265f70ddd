#include "datasets/sources/observation_decoder.hpp"

#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <cstdlib>

#include "datasets/sources/rawlog_decoder.hpp"
#include "datasets/sources/recording.hpp"
#include "tests/worlds/sample_frames.hpp"

namespace clearway {
namespace observation_decoder_test {

std::string mrpt_log(const std::string& name) {
  const char* given = std::getenv("CLEARWAY_MRPT_DATASETS");
  return (given ? std::string(given) : "/usr/share/mrpt/datasets") + "/" + name;
}

/// Everything a rawlog holds, by MRPT's own loader, flattened.
struct MrptLog {
  mrpt::obs::CRawlog log;
  std::vector<mrpt::obs::CObservation::Ptr> observations;
  std::vector<mrpt::poses::CPose3D> robot;  // where it was, by the sum of the increments
  size_t movements = 0;
};
MrptLog load_with_mrpt(const std::string& file) {
  register_rawlog_classes();
  MrptLog result;
  EXPECT_TRUE(result.log.loadFromRawLogFile(file));
  mrpt::poses::CPose2D pose;
  for (size_t i = 0; i < result.log.size(); ++i) {
    if (result.log.getType(i) == mrpt::obs::CRawlog::etActionCollection) {
      const auto movement = result.log.getAsAction(i)->getActionByClass<mrpt::obs::CActionRobotMovement2D>();
      if (movement) pose = pose + movement->poseChange->getMeanVal(), ++result.movements;
    } else if (result.log.getType(i) == mrpt::obs::CRawlog::etSensoryFrame) {
      for (const auto& observation : *result.log.getAsObservations(i)) {
        result.observations.push_back(observation);
        result.robot.push_back(mrpt::poses::CPose3D(pose));
      }
    } else {
      result.observations.push_back(result.log.getAsObservation(i));
      result.robot.emplace_back();
    }
  }
  return result;
}

class RealLog : public testing::TestWithParam<const char*> {};

TEST_P(RealLog, HasAsManyObjectsAsMrptsOwnLoaderFinds) {
  const std::string file = mrpt_log(GetParam());
  MrptLog expected = load_with_mrpt(file);
  RecordingReader reader(file);
  const auto frames = read_all(reader);
  EXPECT_FALSE(reader.damage()) << *reader.damage();
  // MRPT keeps the comment beside its list.
  EXPECT_EQ(reader.counts().objects, expected.log.size() + reader.counts().comments);
  EXPECT_EQ(
      reader.counts().images + reader.counts().clouds + reader.counts().odometry + reader.counts().comments,
      frames.size());
  EXPECT_EQ(reader.progress(), 1);
}

INSTANTIATE_TEST_SUITE_P(OfMrpt, RealLog,
                         testing::Values("2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog",
                                         "localization_demo.rawlog", "tests_rgbd.rawlog",
                                         "test_velodyne_VLP16.rawlog", "uwb_ro-localization_demo.rawlog",
                                         "kf-slam_6D_demo.rawlog", "test_rtk_path.rawlog"),
                         [](const auto& log) { return "log" + std::to_string(log.index); });

TEST(ObservationDecoder, LaserScansLieWhereMrptPutsThem) {
  const std::string file = mrpt_log("localization_demo.rawlog");
  const MrptLog expected = load_with_mrpt(file);
  RecordingReader reader(file);
  size_t scans = 0, index = 0;
  for (const auto& frame : read_all(reader)) {
    const auto* cloud = std::get_if<CloudFrame>(&frame.content);
    if (!cloud) continue;
    while (!std::dynamic_pointer_cast<mrpt::obs::CObservation2DRangeScan>(expected.observations.at(index)))
      ++index;
    const auto& scan = dynamic_cast<mrpt::obs::CObservation2DRangeScan&>(*expected.observations[index]);
    mrpt::maps::CSimplePointsMap map;
    map.insertionOptions.minDistBetweenLaserPoints = 0;
    map.insertionOptions.also_interpolate = false;
    map.loadFromRangeScan(scan, expected.robot[index]);
    ASSERT_EQ(cloud->points.size(), map.size()) << "scan " << scans;
    for (size_t i = 0; i < map.size(); i += 7) {
      Eigen::Vector3f point;
      map.getPoint(i, point.x(), point.y(), point.z());
      const Eigen::Vector3d ours = cloud->world_from_sensor * cloud->points[i].cast<double>();
      EXPECT_LT((ours - point.cast<double>()).norm(), 1e-4);
    }
    ++scans;
    ++index;
  }
  EXPECT_EQ(scans, 37u);
}

TEST(ObservationDecoder, KinectPointsLieWhereMrptPutsThem) {
  const std::string file = mrpt_log("tests_rgbd.rawlog");
  const MrptLog expected = load_with_mrpt(file);
  auto& scan = dynamic_cast<mrpt::obs::CObservation3DRangeScan&>(*expected.observations.at(0));
  mrpt::maps::CSimplePointsMap map;
  mrpt::obs::T3DPointsProjectionParams parameters;
  parameters.takeIntoAccountSensorPoseOnRobot = false;
  scan.unprojectInto(map, parameters);
  RecordingReader reader(file);
  const auto frames = read_all(reader);
  ASSERT_EQ(frames.size(), 2u);
  const auto& cloud = std::get<CloudFrame>(frames[0].content);
  ASSERT_EQ(cloud.points.size(), map.size());
  double worst = 0;
  for (size_t i = 0; i < map.size(); i += 11) {
    Eigen::Vector3f point;
    map.getPoint(i, point.x(), point.y(), point.z());
    worst = std::max<double>(worst, (point - cloud.points[i]).norm());
  }
  EXPECT_LT(worst, 2e-3);
  const auto& image = std::get<ImageFrame>(frames[1].content);
  EXPECT_EQ(image.image.width, 640);
  EXPECT_EQ(image.image.pixels[320 * 240], scan.intensityImage.grayscale().at<uint8_t>(0, 120));
  // The Kinect's colour camera looks along the sensor's x.
  EXPECT_TRUE(image.world_from_sensor.linear().col(2).isApprox(Eigen::Vector3d::UnitX(), 0.1));
}

std::vector<decltype(Frame::content)> decoded(const mrpt::obs::CObservation& observation,
                                              std::vector<std::string>* skipped = nullptr) {
  std::vector<decltype(Frame::content)> contents;
  decode_observation(
      observation, mrpt::poses::CPose3D(), [&](auto&& content) { contents.push_back(std::move(content)); },
      [&](const std::string& why) {
        if (skipped) skipped->push_back(why);
      });
  return contents;
}

TEST(ObservationDecoder, ReadsRangesAndDepthsAlike) {
  mrpt::obs::CObservation3DRangeScan scan;
  scan.hasRangeImage = true;
  scan.rangeUnits = 0.01f;
  scan.rangeImage_setSize(3, 5);
  scan.rangeImage.fill(0);
  scan.rangeImage(0, 4) = 200;
  scan.cameraParams.setIntrinsicParamsFromValues(2, 2, 2, 1);
  const Eigen::Vector3d ray(1, -1, 0.5);  // of column 4, row 0
  for (bool is_depth : {true, false}) {
    scan.range_is_depth = is_depth;
    const auto cloud = std::get<CloudFrame>(decoded(scan).at(0));
    ASSERT_EQ(cloud.points.size(), 1u);
    const Eigen::Vector3d expected =
        is_depth ? Eigen::Vector3d(2 * ray) : Eigen::Vector3d(2 * ray.normalized());
    EXPECT_TRUE(cloud.points[0].cast<double>().isApprox(expected, 1e-5));
  }
}

TEST(ObservationDecoder, ColourBecomesGreyAndExternalImagesAreNamed) {
  mrpt::obs::CObservationImage observation;
  observation.image.resize(4, 3, mrpt::img::CH_RGB);
  observation.image.filledRectangle(0, 0, 3, 2, mrpt::img::TColor(255, 255, 255));
  const auto image = std::get<ImageFrame>(decoded(observation).at(0));
  EXPECT_EQ(image.image, (GrayImage{4, 3, std::vector<uint8_t>(12, 255)}));

  observation.image.setExternalStorage("elsewhere/picture.jpg");
  std::vector<std::string> skipped;
  EXPECT_TRUE(decoded(observation, &skipped).empty());
  ASSERT_EQ(skipped.size(), 1u);
  EXPECT_NE(skipped[0].find("elsewhere/picture.jpg"), std::string::npos) << skipped[0];
}

TEST(ObservationDecoder, InvalidAndOutOfRangeBeamsAreLeftOut) {
  mrpt::obs::CObservation2DRangeScan scan;
  scan.aperture = static_cast<float>(M_PI);
  scan.maxRange = 10;
  const float ranges[] = {1, 2, 10, 4, 5};
  const char valid[] = {1, 0, 1, 1, 1};
  scan.loadFromVectors(5, ranges, valid);
  const auto cloud = std::get<CloudFrame>(decoded(scan).at(0));
  ASSERT_EQ(cloud.points.size(), 3u);
  EXPECT_TRUE(cloud.points[0].isApprox(Eigen::Vector3f(0, -1, 0), 1e-5f));
  EXPECT_TRUE(cloud.points[2].isApprox(Eigen::Vector3f(0, 5, 0), 1e-5f));
  scan.rightToLeft = false;
  EXPECT_TRUE(std::get<CloudFrame>(decoded(scan).at(0)).points[0].isApprox(Eigen::Vector3f(0, 1, 0), 1e-5f));
}

TEST(ObservationDecoder, BeamsThatMetNothingAreCountedAndReachTheRange) {
  mrpt::obs::CObservation2DRangeScan scan;
  scan.aperture = static_cast<float>(M_PI);
  scan.maxRange = 10;
  const float ranges[] = {INFINITY, 2, NAN, -INFINITY, INFINITY};
  const char valid[] = {0, 1, 0, 0, 1};
  scan.loadFromVectors(5, ranges, valid);
  auto cloud = std::get<CloudFrame>(decoded(scan).at(0));
  EXPECT_EQ(cloud.points.size(), 1u);
  EXPECT_EQ(cloud.infinite, 2u);
  ASSERT_EQ(cloud.clear_to.size(), 2u);
  EXPECT_TRUE(cloud.clear_to[0].isApprox(Eigen::Vector3f(0, -10, 0), 1e-5f));
  EXPECT_TRUE(cloud.clear_to[1].isApprox(Eigen::Vector3f(0, 10, 0), 1e-5f));
  scan.maxRange = 0;
  cloud = std::get<CloudFrame>(decoded(scan).at(0));
  EXPECT_EQ(cloud.infinite, 2u);
  EXPECT_TRUE(cloud.clear_to.empty());
}

mrpt::poses::CPose3D tilted() { return mrpt::poses::CPose3D(0.5, -1.0, 2.0, 0.3, -0.2, 0.1); }

/// The point in the world, as MRPT composes it.
Eigen::Vector3d placed_by_mrpt(const Eigen::Vector3f& point) {
  Eigen::Vector3d placed;
  tilted().composePoint(point.x(), point.y(), point.z(), placed.x(), placed.y(), placed.z());
  return placed;
}

TEST(ObservationDecoder, APointCloudKeepsItsFinitePointsAndItsSensorsPose) {
  mrpt::obs::CObservationPointCloud observation;
  auto cloud = mrpt::maps::CSimplePointsMap::Create();
  for (int i = 0; i < 100; ++i) cloud->insertPoint(0.01F * i, 1.0F, -0.5F);
  cloud->insertPoint(NAN, 0.0F, 0.0F);
  observation.pointcloud = cloud;
  observation.sensorPose = tilted();
  const auto frame = std::get<CloudFrame>(decoded(observation).at(0));
  EXPECT_EQ(frame.kind, "points");
  ASSERT_EQ(frame.points.size(), 100U);
  const Eigen::Vector3d ours = frame.world_from_sensor * frame.points[70].cast<double>();
  EXPECT_LT((ours - placed_by_mrpt({0.7F, 1.0F, -0.5F})).norm(), 1e-6);

  observation.setAsExternalStorage("elsewhere/cloud.bin",
                                   mrpt::obs::CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
  std::vector<std::string> skipped;
  EXPECT_TRUE(decoded(observation, &skipped).empty());
  EXPECT_EQ(skipped.size(), 1U);
}

TEST(ObservationDecoder, AVelodyneScanKeepsItsReturnsAndItsSensorsPose) {
  mrpt::obs::CObservationVelodyneScan observation;
  observation.maxRange = 120.0F;
  observation.sensorPose = tilted();
  for (int i = 1; i <= 50; ++i) {
    observation.point_cloud.x.push_back(0.2F * static_cast<float>(i));
    observation.point_cloud.y.push_back(-1.0F);
    observation.point_cloud.z.push_back(0.25F);
  }
  for (auto* axis : {&observation.point_cloud.x, &observation.point_cloud.y, &observation.point_cloud.z}) {
    axis->push_back(0.0F);  // no return
  }
  const auto frame = std::get<CloudFrame>(decoded(observation).at(0));
  EXPECT_EQ(frame.kind, "velodyne");
  EXPECT_EQ(frame.max_range, 120.0);
  ASSERT_EQ(frame.points.size(), 50U);
  const Eigen::Vector3d ours = frame.world_from_sensor * frame.points[9].cast<double>();
  EXPECT_LT((ours - placed_by_mrpt({2.0F, -1.0F, 0.25F})).norm(), 1e-6);
}

TEST(ObservationDecoder, OfAStereoPairTheLeftImageIsRead) {
  mrpt::obs::CObservationStereoImages pair;
  pair.imageLeft.resize(4, 3, mrpt::img::CH_GRAY);
  pair.imageLeft.at<uint8_t>(2, 1) = 77;
  pair.imageRight.resize(4, 3, mrpt::img::CH_GRAY);
  pair.leftCamera.setIntrinsicParamsFromValues(500.0, 501.0, 2.0, 1.5);
  pair.leftCamera.ncols = 4;
  pair.leftCamera.nrows = 3;
  pair.cameraPose = mrpt::poses::CPose3DQuat(tilted());
  const auto frames = decoded(pair);
  ASSERT_EQ(frames.size(), 1U);
  const auto image = std::get<ImageFrame>(frames[0]);
  EXPECT_EQ(image.image.width, 4);
  EXPECT_EQ(image.intrinsics.fy, 501.0);
  EXPECT_LT((image.world_from_sensor.translation() - placed_by_mrpt({0.0F, 0.0F, 0.0F})).norm(), 1e-6);
}

TEST(ObservationDecoder, SensorsThatAreNotReadAreNamed) {
  mrpt::obs::CObservationRotatingScan turning;
  turning.sensorLabel = "Velodyne";
  std::vector<std::string> skipped;
  EXPECT_TRUE(decoded(turning, &skipped).empty());
  EXPECT_TRUE(decoded(mrpt::obs::CObservationIMU(), &skipped).empty());
  ASSERT_EQ(skipped.size(), 2U);
  EXPECT_EQ(skipped[0], "sensor 'Velodyne': what MRPT keeps as CObservationRotatingScan is not read");
  EXPECT_EQ(skipped[1], "");
}

TEST(ObservationDecoder, PointsOfARangeCameraAreReadWhereItHasNoRangeImage) {
  mrpt::obs::CObservation3DRangeScan scan;
  scan.hasPoints3D = true;
  scan.points3D_x = {1.0F, 0.0F, 2.0F};
  scan.points3D_y = {0.5F, 0.0F, NAN};
  scan.points3D_z = {0.25F, 0.0F, 1.0F};
  scan.sensorPose = tilted();
  const auto frame = std::get<CloudFrame>(decoded(scan).at(0));
  ASSERT_EQ(frame.points.size(), 1U);
  EXPECT_LT(
      (frame.world_from_sensor * frame.points[0].cast<double>() - placed_by_mrpt({1.0F, 0.5F, 0.25F})).norm(),
      1e-6);
}

}  // namespace observation_decoder_test
}  // namespace clearway
