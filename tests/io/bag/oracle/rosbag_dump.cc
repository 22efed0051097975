// SPDX-License-Identifier: Apache-2.0
// A line for each message of a bag, as ROS 1's own library reads it. It checks the MD5 sums of
// types.
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  rosbag::Bag bag(argv[1], rosbag::bagmode::Read);
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    std::cout << message.getTopic() << " " << message.getTime().toNSec();
    if (const auto scan = message.instantiate<sensor_msgs::PointCloud2>()) {
      std::cout << " " << scan->header.frame_id << " " << scan->width << " " << scan->point_step;
      for (const auto& field : scan->fields) std::cout << " " << field.name << field.offset;
    }
    if (const auto image = message.instantiate<sensor_msgs::Image>()) {
      std::cout << " " << image->width << " " << image->height << " " << image->encoding << " "
                << std::string(image->data.begin(), image->data.end());
    }
    if (const auto image = message.instantiate<sensor_msgs::CompressedImage>()) {
      std::cout << " " << image->format << " " << image->data.size();
    }
    if (const auto camera = message.instantiate<sensor_msgs::CameraInfo>()) {
      std::cout << " " << camera->distortion_model << " " << camera->D.size() << " " << camera->K[0]
                << " " << camera->P[5] << " " << camera->roi.width;
    }
    std::cout << "\n";
  }
}
