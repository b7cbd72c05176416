// Says in sentences what a robot of a recording did, and why.
#pragma once

#include <string>
#include <vector>

#include "monitor/recording/robot_story.h"

namespace coppice {

/// What the robot did in an episode, with the times and the place.
std::string sentence_of(const RobotName& robot, const Episode& e);

/// The whole recording: a sentence for each change of what the robot did, or of its cause.
std::vector<std::string> explain_run(const Stories& stories, const RobotName& robot);

/// One moment: where the robot was, what it did and why, and whom it waited for, to the end of the chain.
/// `time`: as in the stories, which are those of the recording.
std::vector<std::string> explain_moment(const Recording& recording, const Stories& stories,
                                        const RobotName& robot, double time);

/// Throws InputError, which names the nearest name, if the recording does not know the robot.
void check_robot(const Stories& stories, const RobotName& robot);
/// Throws InputError unless the recording holds that time.
void check_time(const Stories& stories, double time);

}  // namespace coppice
