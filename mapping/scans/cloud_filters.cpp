#include "mapping/scans/cloud_filters.hpp"

#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

namespace clearway {
namespace {

pcl::PointCloud<pcl::PointXYZ>::Ptr pcl_cloud(const std::vector<Eigen::Vector3f>& points) {
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(points.size());
  for (const auto& point : points) cloud->push_back({point.x(), point.y(), point.z()});
  return cloud;
}

}  // namespace

std::vector<int> inliers(const std::vector<Eigen::Vector3f>& points, int neighbours, double deviations) {
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> removal;
  removal.setInputCloud(pcl_cloud(points));
  removal.setMeanK(neighbours);
  removal.setStddevMulThresh(deviations);
  pcl::Indices kept;
  removal.filter(kept);
  return {kept.begin(), kept.end()};
}

}  // namespace clearway
