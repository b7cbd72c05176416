// Seconds since the monitor or a robot was last heard: what is shown of it is then marked as old, or counts as lost
// (messages/silence.h).
export const oldAfter = 1;
export const lostAfter = 3;
