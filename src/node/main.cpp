// rosrun robot_cloth cloth_node. Exit codes: 0 done, 1 the engine could not go on, 2 something to
// fix at start: the message names it.
#include "cloth_node.h"

#include <csignal>
#include <cstdio>
#include <ros/console.h>
#include <ros/init.h>

int main(int argc, char **argv)
{
  ros::init(argc, argv, "cloth");
  // roscpp minds SIGINT only; a container or service manager sends this one
  std::signal(SIGTERM, [](int) { ros::requestShutdown(); });
  const ros::NodeHandle nh, priv("~");
  try {
    robot_cloth::ClothNode node(nh, priv);
    node.start();
    while (ros::ok() && !node.finished()) ros::WallDuration(0.02).sleep();
    node.stop();
    // not through rosout: at shutdown that is gone, and `make demo` shows this
    std::printf("cloth: summary of the run\n%s\n", node.summary().c_str());
    std::fflush(stdout);
    return node.failed() ? 1 : 0;
  } catch (const robot_cloth::StartError &e) {
    if (ros::ok())
      ROS_FATAL_STREAM(e.what());
    else
      std::fprintf(stderr, "cloth: %s\n", e.what()); // interrupted: the console is closed already
    return 2;
  } catch (const std::exception &e) {
    ROS_FATAL_STREAM("cannot start: " << e.what());
    return 2;
  }
}
