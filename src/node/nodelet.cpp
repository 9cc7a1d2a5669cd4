// The node as a nodelet: robot_cloth/ClothNodelet.
#include "cloth_node.h"

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

namespace robot_cloth {

class ClothNodelet : public nodelet::Nodelet {
  void onInit() override
  {
    // The loader keeps the other nodelets running, but has no word for what it catches.
    try {
      node_ = std::make_unique<ClothNode>(getNodeHandle(), getPrivateNodeHandle());
      node_->start();
    } catch (const std::exception &e) {
      NODELET_FATAL_STREAM(e.what());
      throw;
    }
  }
  std::unique_ptr<ClothNode> node_;
};

} // namespace robot_cloth

PLUGINLIB_EXPORT_CLASS(robot_cloth::ClothNodelet, nodelet::Nodelet)
