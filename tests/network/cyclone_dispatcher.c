// cyclone_dispatcher DOMAIN ID ROBOT X Y SECONDS: orders a robot to a place by Cyclone DDS, and prints the
// states of the order until it has ended. It knows nothing of Coppice but idl/fleet.idl.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dds/dds.h"
#include "fleet.h"

enum { done = 3 };  // of OrderStatus.state

static dds_qos_t* durable(void) {
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  return qos;
}

static int give(dds_entity_t writer, char* const* arguments) {
  coppice_idl_RobotId robot;
  memset(&robot, 0, sizeof robot);
  strncpy(robot.robot, arguments[3], sizeof robot.robot - 1);
  coppice_idl_Visit visit;
  memset(&visit, 0, sizeof visit);
  visit.position.x = strtod(arguments[4], NULL);
  visit.position.y = strtod(arguments[5], NULL);
  coppice_idl_Order order;
  memset(&order, 0, sizeof order);
  strncpy(order.id, arguments[2], sizeof order.id - 1);
  strncpy(order.by, "cyclone", sizeof order.by - 1);
  order.robots._length = order.robots._maximum = 1;
  order.robots._buffer = &robot;
  order.visits._length = order.visits._maximum = 1;
  order.visits._buffer = &visit;
  return dds_write(writer, &order);
}

/// The last state of the order that was printed; below 0: none.
static int print_news(dds_entity_t reader, const char* id, int last) {
  void* samples[16] = {NULL};
  dds_sample_info_t infos[16];
  const int n = dds_take(reader, samples, infos, 16, 16);
  for (int i = 0; i < n; ++i) {
    const coppice_idl_OrderStatus* const status = samples[i];
    if (!infos[i].valid_data || strcmp(status->id, id) != 0 || status->state == last) continue;
    last = status->state;
    printf("state %d robot %s reason %s\n", last, status->robot, status->reason);
  }
  if (n > 0) dds_return_loan(reader, samples, n);
  return last;
}

int main(int argc, char** argv) {
  if (argc != 7) return 2;
  const dds_time_t end = dds_time() + DDS_SECS(strtol(argv[6], NULL, 10));
  const dds_entity_t participant =
      dds_create_participant((dds_domainid_t)strtol(argv[1], NULL, 10), NULL, NULL);
  dds_qos_t* const qos = durable();
  const dds_entity_t orders = dds_create_topic(participant, &coppice_idl_Order_desc, "order", NULL, NULL);
  const dds_entity_t statuses =
      dds_create_topic(participant, &coppice_idl_OrderStatus_desc, "order_status", NULL, NULL);
  const dds_entity_t writer = dds_create_writer(participant, orders, qos, NULL);
  const dds_entity_t reader = dds_create_reader(participant, statuses, qos, NULL);
  dds_delete_qos(qos);
  if (participant < 0 || writer < 0 || reader < 0 || give(writer, argv) < 0) return 3;
  int last = -1;
  while (last < done && dds_time() < end) {
    last = print_news(reader, argv[2], last);
    dds_sleepfor(DDS_MSECS(10));
  }
  dds_delete(participant);
  return last == done ? 0 : 1;
}
