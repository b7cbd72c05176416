#include <iostream>
#include <string>
#include <vector>

#include "coppice/commands.h"
#include "monitor/recording/explanation.h"

namespace coppice {

int explain_command(const ExplainOptions& options) {
  const Recording recording(options.recording);
  const Stories stories = stories_of(recording);
  check_robot(stories, options.robot);
  if (options.time) check_time(stories, *options.time);
  const std::vector<std::string> lines =
      options.time ? explain_moment(recording, stories, options.robot, *options.time)
                   : explain_run(stories, options.robot);
  for (const std::string& line : lines) std::cout << line << '\n';
  return 0;
}

}  // namespace coppice
