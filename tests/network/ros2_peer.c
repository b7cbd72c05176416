// A program that looks like ROS 2 to DDS, on another vendor's DDS. It knows idl/ros2.idl and nothing else of
// Coppice.
//
// ros2_peer DOMAIN ROBOT goal X Y SECONDS
//     reads /map and /ROBOT/odom, writes /ROBOT/goal_pose, and waits until the robot stands there
// ros2_peer DOMAIN ROBOT robot X Y LAG NOISE PAUSE_AT PAUSE
//     is a holonomic robot that begins at X Y. It obeys /ROBOT/cmd_vel with a lag (first order, seconds), and
//     writes /ROBOT/odom with noise (metres, uniform). PAUSE_AT seconds after it first moved, the odometry
//     stops for PAUSE seconds. Prints time, true position, speed, and whether it is silent, until it is
//     stopped
// ros2_peer DOMAIN ROBOT differential X Y YAW LAG NOISE SLIP PAUSE_AT PAUSE SOURCE
//     is a robot with two driven wheels that begins at X Y with a yaw. Each wheel loses up to SLIP of its
//     speed. The noise is normal (standard deviation, metres, and as many radians). SOURCE: odom; or tf, with
//     stamped commands: the robot then says where it is in the frame odom, which lies 1 m beside the map's.
//     Prints the same, and its yaw. A velocity to the side ends it with exit code 4
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dds/dds.h"
#include "ros2.h"

#define ODOMETRY_PERIOD 0.04      // seconds
#define STEP 0.01                 // seconds
#define COMMAND_IS_OLD_AFTER 0.5  // seconds; then it stops, as real drives do

static dds_entity_t participant;

static double now_in_seconds(void) {
  return (double)dds_time() / 1e9;
}

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity >= 0) return entity;
  fprintf(stderr, "%s: %s\n", what, dds_strretcode(entity));
  exit(3);
}

static dds_entity_t topic_of(const dds_topic_descriptor_t* type, const char* robot, const char* name) {
  char topic[300];
  snprintf(topic, sizeof topic, "rt%s%s/%s", robot[0] ? "/" : "", robot, name);
  return checked(dds_create_topic(participant, type, topic, NULL, NULL), topic);
}

// The default QoS of ROS 2. `keeps`: also earlier samples, as map displays request.
static dds_qos_t* qos_of(int keeps) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, keeps ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, keeps ? 1 : 10);
  return qos;
}

static dds_entity_t reader_of(const dds_topic_descriptor_t* type, const char* robot, const char* name,
                              int keeps) {
  dds_qos_t* qos = qos_of(keeps);
  const dds_entity_t reader =
      checked(dds_create_reader(participant, topic_of(type, robot, name), qos, NULL), name);
  dds_delete_qos(qos);
  return reader;
}

static dds_entity_t writer_of(const dds_topic_descriptor_t* type, const char* robot, const char* name) {
  dds_qos_t* qos = qos_of(0);
  const dds_entity_t writer =
      checked(dds_create_writer(participant, topic_of(type, robot, name), qos, NULL), name);
  dds_delete_qos(qos);
  return writer;
}

// The next sample, which must be given back; null if there is none.
static void* take(dds_entity_t reader) {
  void* sample[1] = {NULL};
  dds_sample_info_t info;
  for (;;) {
    if (dds_take(reader, sample, &info, 1, 1) <= 0) return NULL;
    if (info.valid_data) return sample[0];
    dds_return_loan(reader, sample, 1);
    sample[0] = NULL;
  }
}

static void give_back(dds_entity_t reader, void* sample) {
  dds_return_loan(reader, &sample, 1);
}

static int send_to_goal(const char* robot, double x, double y, double seconds) {
  const dds_entity_t maps = reader_of(&nav_msgs_msg_dds__OccupancyGrid__desc, "", "map", 1);
  const dds_entity_t plans = reader_of(&nav_msgs_msg_dds__Path__desc, robot, "plan", 1);
  const dds_entity_t places = reader_of(&nav_msgs_msg_dds__Odometry__desc, robot, "odom", 0);
  const dds_entity_t transforms = reader_of(&tf2_msgs_msg_dds__TFMessage__desc, "", "tf", 0);
  const dds_entity_t goals = writer_of(&geometry_msgs_msg_dds__PoseStamped__desc, robot, "goal_pose");
  const double end = now_in_seconds() + seconds;
  int knows_map = 0, asked = 0, there = 0, transformed = 0;
  while (!there && now_in_seconds() < end) {
    nav_msgs_msg_dds__OccupancyGrid_* map = take(maps);
    if (map) {
      const nav_msgs_msg_dds__MapMetaData_* info = &map->info;
      unsigned long occupied = 0;
      for (uint32_t k = 0; k < map->data._length; ++k) occupied += map->data._buffer[k] == 100;
      printf("map %s %ux%u cells of %.3f m from %.3f %.3f, %lu occupied, corner %u\n", map->header.frame_id,
             info->width, info->height, info->resolution, info->origin.position.x, info->origin.position.y,
             occupied, map->data._buffer[0]);
      knows_map = 1;
      give_back(maps, map);
    }
    nav_msgs_msg_dds__Path_* plan = take(plans);
    if (plan) {
      const uint32_t n = plan->poses._length;
      if (n > 0)
        printf("plan %s to %.3f %.3f\n", plan->header.frame_id, plan->poses._buffer[n - 1].pose.position.x,
               plan->poses._buffer[n - 1].pose.position.y);
      give_back(plans, plan);
    }
    tf2_msgs_msg_dds__TFMessage_* tf = take(transforms);
    if (tf) {
      for (uint32_t k = 0; k < tf->transforms._length && !transformed; ++k)
        printf("tf %s -> %s\n", tf->transforms._buffer[k].header.frame_id,
               tf->transforms._buffer[k].child_frame_id);
      transformed = 1;
      give_back(transforms, tf);
    }
    nav_msgs_msg_dds__Odometry_* odom = take(places);
    if (odom) {
      const geometry_msgs_msg_dds__Point_* p = &odom->pose.pose.position;
      const double speed = hypot(odom->twist.twist.linear.x, odom->twist.twist.linear.y);
      there = asked && speed < 0.01 && hypot(p->x - x, p->y - y) < 0.6;
      dds_publication_matched_status_t matched;
      dds_get_publication_matched_status(goals, &matched);
      if (!asked && knows_map && matched.current_count > 0) {
        printf("odom %s -> %s at %.3f %.3f, %.1f s old\n", odom->header.frame_id, odom->child_frame_id, p->x,
               p->y, now_in_seconds() - odom->header.stamp.sec - 1e-9 * odom->header.stamp.nanosec);
        geometry_msgs_msg_dds__PoseStamped_ goal;
        memset(&goal, 0, sizeof goal);
        goal.header.frame_id = "map";
        goal.pose.position.x = x;
        goal.pose.position.y = y;
        goal.pose.orientation.w = 1;
        dds_write(goals, &goal);
        asked = 1;
      }
      if (there) printf("there\n");
      give_back(places, odom);
    }
    fflush(stdout);
    dds_sleepfor(DDS_MSECS(5));
  }
  return there ? 0 : 1;
}

static double noise(double largest) {
  return largest * (2.0 * rand() / RAND_MAX - 1);
}

// A message that has its header alone.
static nav_msgs_msg_dds__Odometry_ odometry_at(double t) {
  nav_msgs_msg_dds__Odometry_ odom;
  memset(&odom, 0, sizeof odom);
  odom.header.stamp.sec = (int32_t)t;
  odom.header.stamp.nanosec = (uint32_t)((t - floor(t)) * 1e9);
  odom.header.frame_id = "map";
  odom.child_frame_id = "base_link";
  return odom;
}

static int be_the_robot(const char* robot, double x, double y, double lag, double largest_noise,
                        double pause_at, double pause) {
  const dds_entity_t commands = reader_of(&geometry_msgs_msg_dds__Twist__desc, robot, "cmd_vel", 0);
  const dds_entity_t places = writer_of(&nav_msgs_msg_dds__Odometry__desc, robot, "odom");
  const double yaw = 0.5;  // it always faces that way: velocities are in its frame, not the map's
  double wanted_x = 0, wanted_y = 0, vx = 0, vy = 0, heard = 0, set_off = 0, next_odometry = 0;
  for (double t = now_in_seconds();; t += STEP) {
    while (now_in_seconds() < t) dds_sleepfor(DDS_MSECS(1));
    geometry_msgs_msg_dds__Twist_* twist;
    while ((twist = take(commands))) {
      wanted_x = cos(yaw) * twist->linear.x - sin(yaw) * twist->linear.y;
      wanted_y = sin(yaw) * twist->linear.x + cos(yaw) * twist->linear.y;
      heard = t;
      give_back(commands, twist);
    }
    if (t - heard > COMMAND_IS_OLD_AFTER) wanted_x = wanted_y = 0;
    vx += (wanted_x - vx) * STEP / lag;
    vy += (wanted_y - vy) * STEP / lag;
    x += vx * STEP;
    y += vy * STEP;
    if (set_off == 0 && hypot(vx, vy) > 0.2) set_off = t;
    const int silent = set_off > 0 && t > set_off + pause_at && t < set_off + pause_at + pause;
    if (t < next_odometry) continue;
    next_odometry = t + ODOMETRY_PERIOD;
    printf("%.3f %.4f %.4f %.4f %d\n", t, x, y, hypot(vx, vy), silent);
    fflush(stdout);
    if (silent) continue;
    nav_msgs_msg_dds__Odometry_ odom = odometry_at(t);
    odom.pose.pose.position.x = x + noise(largest_noise);
    odom.pose.pose.position.y = y + noise(largest_noise);
    odom.pose.pose.orientation.z = sin(yaw / 2);
    odom.pose.pose.orientation.w = cos(yaw / 2);
    odom.twist.twist.linear.x = cos(yaw) * vx + sin(yaw) * vy;
    odom.twist.twist.linear.y = -sin(yaw) * vx + cos(yaw) * vy;
    dds_write(places, &odom);
  }
}

static double normal(double deviation) {
  const double far = sqrt(-2 * log((rand() + 1.0) / (RAND_MAX + 2.0)));
  return deviation * far * cos(2 * M_PI * rand() / RAND_MAX);
}

// What a robot with two driven wheels does, and what it is told.
struct drive {
  double x, y, yaw, speed, turning;
  double wanted_speed, wanted_turning;
};

static void take_command(struct drive* d, const geometry_msgs_msg_dds__Twist_* twist) {
  if (twist->linear.y != 0 || twist->linear.z != 0 || twist->angular.x != 0 || twist->angular.y != 0) {
    fprintf(stderr, "a command to the side: %g\n", twist->linear.y);
    exit(4);
  }
  d->wanted_speed = twist->linear.x;
  d->wanted_turning = twist->angular.z;
}

// The wheels follow with a lag, and slip. The robot drives on an arc (midpoint rule).
static void move_on(struct drive* d, double lag, double left_grip, double right_grip) {
  const double half_track = 0.15;  // metres
  const double share = lag > 0 ? 1 - exp(-STEP / lag) : 1;
  d->speed += share * (d->wanted_speed - d->speed);
  d->turning += share * (d->wanted_turning - d->turning);
  const double left = left_grip * (d->speed - half_track * d->turning);
  const double right = right_grip * (d->speed + half_track * d->turning);
  const double middle = d->yaw + (right - left) / (2 * half_track) * STEP / 2;
  d->x += (left + right) / 2 * cos(middle) * STEP;
  d->y += (left + right) / 2 * sin(middle) * STEP;
  d->yaw += (right - left) / (2 * half_track) * STEP;
}

static void say_by_odometry(dds_entity_t writer, const struct drive* d, double t, double deviation) {
  nav_msgs_msg_dds__Odometry_ odom = odometry_at(t);
  odom.pose.pose.position.x = d->x + normal(deviation);
  odom.pose.pose.position.y = d->y + normal(deviation);
  const double yaw = d->yaw + normal(deviation);
  odom.pose.pose.orientation.z = sin(yaw / 2);
  odom.pose.pose.orientation.w = cos(yaw / 2);
  odom.twist.twist.linear.x = d->speed;
  odom.twist.twist.angular.z = d->turning;
  dds_write(writer, &odom);
}

// map -> odom is a shift by 1 m. odom -> base_link moves.
static void say_by_transforms(dds_entity_t writer, const char* robot, const struct drive* d,
                              double deviation) {
  char odom[300], base[300];
  snprintf(odom, sizeof odom, "%s/odom", robot);
  snprintf(base, sizeof base, "%s/base_link", robot);
  geometry_msgs_msg_dds__TransformStamped_ links[2];
  memset(links, 0, sizeof links);
  links[0].header.frame_id = "map";
  links[0].child_frame_id = odom;
  links[0].transform.translation.x = 1;
  links[0].transform.rotation.w = 1;
  links[1].header.frame_id = odom;
  links[1].child_frame_id = base;
  links[1].transform.translation.x = d->x - 1 + normal(deviation);
  links[1].transform.translation.y = d->y + normal(deviation);
  const double yaw = d->yaw + normal(deviation);
  links[1].transform.rotation.z = sin(yaw / 2);
  links[1].transform.rotation.w = cos(yaw / 2);
  tf2_msgs_msg_dds__TFMessage_ message;
  memset(&message, 0, sizeof message);
  message.transforms._buffer = links;
  message.transforms._length = message.transforms._maximum = 2;
  dds_write(writer, &message);
}

static int be_a_differential_robot(const char* robot, char** argv) {
  struct drive d = {atof(argv[0]), atof(argv[1]), atof(argv[2]), 0, 0, 0, 0};
  const double lag = atof(argv[3]), deviation = atof(argv[4]), slip = atof(argv[5]);
  const double pause_at = atof(argv[6]), pause = atof(argv[7]);
  const int by_tf = strcmp(argv[8], "tf") == 0;
  const dds_entity_t commands =
      reader_of(by_tf ? &geometry_msgs_msg_dds__TwistStamped__desc : &geometry_msgs_msg_dds__Twist__desc,
                robot, "cmd_vel", 0);
  const dds_entity_t places = by_tf ? writer_of(&tf2_msgs_msg_dds__TFMessage__desc, "", "tf")
                                    : writer_of(&nav_msgs_msg_dds__Odometry__desc, robot, "odom");
  srand((unsigned)(1000 * d.x + d.y));
  const double left_grip = 1 - slip * rand() / RAND_MAX, right_grip = 1 - slip * rand() / RAND_MAX;
  double heard = 0, set_off = 0, next_odometry = 0;
  for (double t = now_in_seconds();; t += STEP) {
    while (now_in_seconds() < t) dds_sleepfor(DDS_MSECS(1));
    void* sample;
    while ((sample = take(commands))) {
      take_command(&d, by_tf ? &((geometry_msgs_msg_dds__TwistStamped_*)sample)->twist
                             : (geometry_msgs_msg_dds__Twist_*)sample);
      heard = t;
      give_back(commands, sample);
    }
    if (t - heard > COMMAND_IS_OLD_AFTER) d.wanted_speed = d.wanted_turning = 0;
    move_on(&d, lag, left_grip, right_grip);
    if (set_off == 0 && fabs(d.speed) > 0.1) set_off = t;
    const int silent = set_off > 0 && t > set_off + pause_at && t < set_off + pause_at + pause;
    if (t < next_odometry) continue;
    next_odometry = t + ODOMETRY_PERIOD;
    printf("%.3f %.4f %.4f %.4f %d %.4f\n", t, d.x, d.y, fabs(d.speed), silent, d.yaw);
    fflush(stdout);
    if (silent) continue;
    if (by_tf)
      say_by_transforms(places, robot, &d, deviation);
    else
      say_by_odometry(places, &d, t, deviation);
  }
}

int main(int argc, char** argv) {
  if (argc < 7) return 2;
  const char* robot = argv[2];
  const double x = atof(argv[4]);
  const double y = atof(argv[5]);
  participant = checked(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  if (strcmp(argv[3], "goal") == 0) {
    const int result = send_to_goal(robot, x, y, atof(argv[6]));
    dds_delete(participant);
    return result;
  }
  if (strcmp(argv[3], "differential") == 0) return argc == 13 ? be_a_differential_robot(robot, argv + 4) : 2;
  if (argc != 10) return 2;
  return be_the_robot(robot, x, y, atof(argv[6]), atof(argv[7]), atof(argv[8]), atof(argv[9]));
}
