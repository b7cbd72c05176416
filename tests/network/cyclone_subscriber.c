// cyclone_subscriber DOMAIN COUNT SECONDS: prints the first COUNT robot states that Cyclone DDS receives.
#include <stdio.h>
#include <stdlib.h>

#include "dds/dds.h"
#include "fleet.h"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const long wanted = strtol(argv[2], NULL, 10);
  const dds_time_t end = dds_time() + DDS_SECS(strtol(argv[3], NULL, 10));
  const dds_entity_t participant =
      dds_create_participant((dds_domainid_t)strtol(argv[1], NULL, 10), NULL, NULL);
  const dds_entity_t topic =
      dds_create_topic(participant, &coppice_idl_RobotState_desc, "robot_state", NULL, NULL);
  const dds_entity_t reader = dds_create_reader(participant, topic, NULL, NULL);
  if (participant < 0 || topic < 0 || reader < 0) return 3;
  long received = 0;
  while (received < wanted && dds_time() < end) {
    void* samples[16] = {NULL};
    dds_sample_info_t infos[16];
    const int n = dds_take(reader, samples, infos, 16, 16);
    for (int i = 0; i < n; ++i) {
      if (!infos[i].valid_data) continue;
      const coppice_idl_RobotState* s = samples[i];
      printf("%s %u %.3f %.3f %.3f\n", s->robot, s->sequence_number, s->stamp, s->position.x, s->position.y);
      ++received;
    }
    if (n > 0) dds_return_loan(reader, samples, n);
    dds_sleepfor(DDS_MSECS(5));
  }
  dds_delete(participant);
  return received >= wanted ? 0 : 1;
}
