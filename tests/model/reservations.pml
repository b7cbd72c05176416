/* Reservations of three robots on lanes that cross: the rules of docs/safety.md, L13 and L14, for Spin (tests/model/run).

   Lanes. A, B and C drive along lanes of cells; each two lanes share one cell. B needs BRAKES steps to brake, A and C
   one. The first reservation of A ends before all crossings: it comes near nobody. Then A gets another goal, drops it,
   and reserves its whole lane. Cells from `at` to `to` are committed: the robot comes to `to` whatever it decides.

   Time goes in steps. In each, robots hear what was said, reserve, decide, move and speak. In this order a message may
   come between two control steps, as it wakes the agent.

   rule of the model            docs/safety.md           code
   overlap                      Invariant 2, L6
   may_be_there                 L2, L4                   NeighbourRegion::clear
   clear_of, decide             L6, L14                  HeldReservation::allows, Driver::safe
   gate_closed                  L14                      HeldReservation::allows
   passes, is_latest            L14                      Reserver::passes, HeldReservation::passes
   may_be_confirmed             L14                      HeldReservation::may_be_confirmed
   related, names_it            L14                      are_related, HeldReservation::pair_with
   may_rely, leave_strip, drop  Leaving a strip          Reserver::may_rely, leave_strip, drop
   note_who_heard               Leaving a strip          Reserver::note_who_heard
   may_be_met, may_leave_strip  Leaving a strip          Reserver::may_leave_strip
   beside, renew                L14                      Reserver::name_those_beside, HeldReservation::renew
   restart                      L13                      Reserver::begin_anew

   Faults. In a step at most one thing goes wrong, and at most FAULTS in a run: an agent decides nothing, a state is
   lost, a partition between two robots begins (once; `partition` says which robot still hears all), or the reservations
   of one robot begin to come late to another (once). Partitions and late messages end at any time. With -DRESTART an
   agent restarts as well, once. With -DCUT_OFF only B and C are parted, once, and agents pause as often as they like.
   A message that comes again is no news, as in Reservations::hear.

   Liveness (-DLIVENESS): a robot reserves as soon as it may, who plans later passes second, and of two that planned
   without each other one plans anew: the model has no times, and free choices could close a circle of gates. A run is
   fair if its partition and its late messages end and its restarted agent comes back.

   Left out: clocks that differ, failed robots and A6 to A10, joint plans, motion between cells, and the way of a robot
   that waits for a gate until the other one is sure to have passed: here it waits until that one has passed.

   One rule at a time is taken out by macro, and the model finds a contact with each:
   RELIANCE_BY_GEOMETRY  the old rule: only robots whose ways come near rely on a reservation.
   TOLD_EXACT            Reserver::leave_strip, as it was: a robot relies if it was told of its newest number. It may have got that
                         number on its way, after decisions that relied on the old one.
   RELATED_BY_NUMBER     are_related, as it was: a basis names one number. Two robots that get new numbers at once lose their order.
   NO_BRAKING            who has heard of the dropped reservation has braked.
   EARLY=n               the wait ends n steps early. A few steps are covered by the reachable set, so n = 5.
   NO_KNOWS, NO_PASSED   an order is confirmed without `knows`; although somebody passed a closed gate.
   KEEPS_IT_FOR_EVER     who is overridden does not drop its reservation: with -DLIVENESS it waits for ever. */
#define A 0
#define B 1
#define C 2
#define NONE 0
#define NEAR 1
#define WHOLE 2

#ifndef RECENT
#define RECENT 2  // steps: older states show nothing
#endif
#ifndef FAULTS
#define FAULTS 3
#endif
#define OLD (RECENT + 2)
#define NEVER (OLD + 1)
#define P(i, j) (3 * (i) + (j))

// The cell of i's lane that it shares with j's.
#define CROSS(i, j) ((i) == A -> ((j) == B -> 2 : 3) : ((i) == B -> ((j) == A -> BRAKES : 1) : ((j) == A -> 1 : 2)))
#ifndef BRAKES
#define BRAKES 3
#endif
#define END(i) ((i) == C -> 3 : ((i) == A -> 4 : BRAKES + 1))
#define BRAKING(i) ((i) == B -> BRAKES : 1)
#define LONGEST_WINDOW BRAKES
#define RANK(i) ((i) == C -> 0 : ((i) == A -> 1 : 2))
#define UNTIL (RECENT + LONGEST_WINDOW - EARLY)
#ifndef EARLY
#define EARLY 0
#endif

byte at[3], to[3], kind[3], number[3], since[3], heard_since[9], basis[9], told[9], knows[9], heard[9], heard_kind[9], heard_basis[9];
byte age[9], seen_at[9], seen_to[9], names[9], until[9], given[9];
bool first[9], heard_first[9], confirmed[9], has_heard[9], overridden[3], down[3];
byte partition, lost, late, paused, faults;   // lost, late: 1 + P(i, j), j is not heard by i; 0: none
bool has_parted, has_been_late, has_restarted;
byte i, j, k, q;

#define stands(r) (at[r] == to[r])
#define holds(r) (kind[r] != NONE)
#define near(i, j) (kind[i] != NEAR && heard_kind[P(i,j)] != NEAR)
#define heeds(i, j) (holds(i) && heard_kind[P(i,j)] != NONE)
#ifdef RELATED_BY_NUMBER
#define names_it(i, j) (basis[P(i,j)] != 0 && basis[P(i,j)] == heard[P(i,j)])
#define is_named(i, j) (heard_basis[P(i,j)] != 0 && heard_basis[P(i,j)] == number[i])
#else
#define names_it(i, j) (basis[P(i,j)] != 0 && basis[P(i,j)] >= heard_since[P(i,j)])
#define is_named(i, j) (heard_basis[P(i,j)] != 0 && heard_basis[P(i,j)] >= since[i])
#endif
#define related(i, j) (!near(i,j) || names_it(i,j) || is_named(i,j))
#define goes_first(i, j) (names_it(i,j) -> first[P(i,j)] : !heard_first[P(i,j)])
#define is_past(i, j) (at[i] > CROSS(i,j))
#define is_beyond(i, j) (seen_at[P(i,j)] > CROSS(j,i))
#define passed_closed(i, j) (near(i,j) && (goes_first(i,j) \
   -> (seen_to[P(i,j)] >= CROSS(j,i) && at[i] <= CROSS(i,j)) \
   : (to[i] >= CROSS(i,j) && !is_beyond(i,j))))
#define may_be_confirmed(i, j) (KNOWS(i,j) && related(i,j) && PASSED(i,j))
#ifdef NO_KNOWS
#define KNOWS(i,j) true
#else
#define KNOWS(i,j) (knows[P(i,j)] == number[i])
#endif
#ifdef NO_PASSED
#define PASSED(i,j) true
#else
#define PASSED(i,j) (!passed_closed(i,j))
#endif
#define is_latest(i, j) (heeds(i,j) && names[P(i,j)] == heard[P(i,j)] && age[P(i,j)] <= RECENT)
#define passes(i, j) (is_latest(i,j) && confirmed[P(i,j)])
#define gate_closed(i, j) (heeds(i,j) && near(i,j) && related(i,j) && !goes_first(i,j) && !is_beyond(i,j))
#define may_be_there(i, j, steps) (!is_beyond(i,j) && (age[P(i,j)] >= OLD || seen_at[P(i,j)] + age[P(i,j)] + (steps) >= CROSS(j,i)))
#define leads_through(i, j, q) (at[i] <= CROSS(i,j) && (q) >= CROSS(i,j))
#define clear_of(i, j, q) (!leads_through(i,j,q) || ((to[i] >= CROSS(i,j) || !gate_closed(i,j)) && (passes(i,j) || !may_be_there(i,j,CROSS(i,j) - at[i]))))
#define may_be_met(i, j) (until[P(i,j)] > 0 && at[i] <= CROSS(i,j) && at[i] + until[P(i,j)] >= CROSS(i,j) && may_be_there(i,j,until[P(i,j)]))
#define others(r, f) (f(r, (r + 1) % 3) && f(r, (r + 2) % 3))
#define not_met(i, j) (!may_be_met(i,j))
#define is_heard(i, j) (age[P(i,j)] != NEVER)
#define may_leave_strip(r) (others(r, not_met))
#define has_joined(r) (others(r, is_heard))
#define overlap(i, j) (at[i] <= CROSS(i,j) && to[i] >= CROSS(i,j) && at[j] <= CROSS(j,i) && to[j] >= CROSS(j,i))
#define touch(i, j) (at[i] == CROSS(i,j) && at[j] == CROSS(j,i))
#define strip_end(r) (kind[r] == NEAR -> 1 : END(r))

#if defined(TOLD_EXACT)
#define may_rely(i, j) (heard_kind[P(i,j)] != NONE && told[P(i,j)] == heard[P(i,j)])
#elif defined(RELIANCE_BY_GEOMETRY)
#define may_rely(i, j) (heard_kind[P(i,j)] != NONE && near(i,j))
#else
#define may_rely(i, j) (heard_kind[P(i,j)] != NONE || heard[P(i,j)] == 0)
#endif

inline leave_strip(r) {
  j = 0;
  do
  :: j < 3 ->
     if
     :: j != r && may_rely(r, j) -> until[P(r,j)] = UNTIL; given[P(r,j)] = number[r]; has_heard[P(r,j)] = false
     :: else
     fi;
     j++
  :: else -> break
  od
}

inline clear_own(r) {
  j = 0;
  do
  :: j < 3 -> basis[P(r,j)] = 0; first[P(r,j)] = false; confirmed[P(r,j)] = false; j++
  :: else -> break
  od;
  overridden[r] = false; since[r] = 0
}

inline drop(r) {
  leave_strip(r);
  kind[r] = NONE;
  number[r]++;
  clear_own(r)
}

inline name(r, is_renewed) {
  j = 0;
  do
  :: j < 3 ->
     if
     :: j != r && heard_kind[P(r,j)] != NONE && near(r,j) && (!is_renewed || related(r,j) || RANK(j) < RANK(r)) ->
        if
        :: is_renewed && is_named(r,j) && !names_it(r,j) -> first[P(r,j)] = !heard_first[P(r,j)]
        :: else
        fi;
        basis[P(r,j)] = heard[P(r,j)]
     :: else -> basis[P(r,j)] = 0; first[P(r,j)] = false
     fi;
     confirmed[P(r,j)] = false;
     j++
  :: else -> break
  od
}

inline hear() {
  i = 0;
  do
  :: i < 3 ->
     j = 0;
     do
     :: j < 3 ->
        if
        :: i == j || down[i] || lost == P(i,j) + 1 || (partition != 0 && partition != i + 1 && partition != j + 1) -> skip
        :: else ->
           if
           :: !down[j] ->
              age[P(i,j)] = 0; seen_at[P(i,j)] = at[j]; seen_to[P(i,j)] = to[j];
              names[P(i,j)] = (holds(j) -> number[j] : 0);
              if
              :: told[P(j,i)] > knows[P(i,j)] -> knows[P(i,j)] = told[P(j,i)]
              :: else
              fi
           :: else
           fi;
           if
           :: late != P(i,j) + 1 && heard[P(i,j)] != number[j] ->
              heard[P(i,j)] = number[j]; heard_kind[P(i,j)] = kind[j]; heard_since[P(i,j)] = since[j];
              heard_basis[P(i,j)] = (holds(j) -> basis[P(j,i)] : 0); heard_first[P(i,j)] = first[P(j,i)];
              confirmed[P(i,j)] = false
           :: else
           fi
        fi;
        j++
     :: else -> break
     od;
     i++
  :: else -> break
  od;
  i = 0; j = 0
}

#ifdef NO_BRAKING
#define NOTE_BRAKING k = 0
#else
#define NOTE_BRAKING skip
#endif

inline note_who_heard(r) {
  j = 0;
  do
  :: j < 3 ->
     if
     :: j != r && until[P(r,j)] > 0 && !has_heard[P(r,j)] && knows[P(r,j)] > given[P(r,j)] ->
        has_heard[P(r,j)] = true;
        k = seen_to[P(r,j)] - seen_at[P(r,j)];
        k = (k > age[P(r,j)] -> k - age[P(r,j)] : 0);
        NOTE_BRAKING;
        until[P(r,j)] = (k < until[P(r,j)] -> k : until[P(r,j)])
     :: else
     fi;
     if
     :: j != r && is_latest(r,j) && may_be_confirmed(r,j) -> confirmed[P(r,j)] = true
     :: else
     fi;
     j++
  :: else -> break
  od;
  k = 0; j = 0
}

#define unnamed(i, j) (heeds(i,j) && !is_beyond(i,j) && !is_past(i,j) && near(i,j) && !related(i,j) && RANK(j) < RANK(i))

inline restart(r) {
  d_step {
  down[r] = true; j = 0;
  do
  :: j < 3 ->
     heard[P(r,j)] = 0; heard_kind[P(r,j)] = NONE; heard_since[P(r,j)] = 0; heard_basis[P(r,j)] = 0; heard_first[P(r,j)] = false;
     age[P(r,j)] = NEVER; seen_at[P(r,j)] = 0; seen_to[P(r,j)] = 0; names[P(r,j)] = 0; knows[P(r,j)] = 0; told[P(r,j)] = 0;
     confirmed[P(r,j)] = false;
     until[P(r,j)] = (j != r -> UNTIL : 0); given[P(r,j)] = 255; has_heard[P(r,j)] = false;
     j++
  :: else -> break
  od; j = 0 }
}

#ifdef CUT_OFF
#define may_pause true
#else
#define may_pause may_fail -> fails
#endif
#define may_fail (faults < FAULTS)
#define fails faults++

inline network() {
  if
  :: true
  :: may_pause; if :: paused = 1 :: paused = 2 :: paused = 3 fi
#ifndef CUT_OFF
  :: may_fail -> fails; if :: lost = 2 :: lost = 3 :: lost = 4 :: lost = 6 :: lost = 7 :: lost = 8 fi
  :: may_fail && !has_parted -> fails; has_parted = true;
     if :: partition = 1 :: partition = 2 :: partition = 3 fi
#else
  :: !has_parted -> has_parted = true; partition = 1
#endif
  :: partition != 0 -> partition = 0
#ifndef CUT_OFF
  :: may_fail && !has_been_late -> fails; has_been_late = true;
     if :: late = 2 :: late = 3 :: late = 4 :: late = 6 :: late = 7 :: late = 8 fi
  :: late != 0 -> late = 0
#endif
#ifdef RESTART
  :: !has_restarted -> has_restarted = true;
     if :: restart(A) :: restart(B) :: restart(C) fi
#endif
  fi
}

#define HAS_TO_DROP(r) (stands(r) && kind[r] == NEAR && at[r] == strip_end(r))

#ifdef KEEPS_IT_FOR_EVER
#define KEEPS_IT (kind[r] != NEAR)
#else
#define KEEPS_IT false
#endif

inline reserve(r) {
  if
  :: down[r] ->
     if
     :: stands(r) -> d_step { down[r] = false; kind[r] = NONE; number[r]++; clear_own(r); j = 0 }
     :: true
     fi
  :: !down[r] && holds(r) ->
     if
     :: stands(r) && (kind[r] == NEAR || overridden[r]) && !KEEPS_IT -> d_step { drop(r); j = 0 }
     :: !overridden[r] && unnamed(r, (r + 1) % 3) -> j = (r + 1) % 3; beside(r)
     :: !overridden[r] && unnamed(r, (r + 2) % 3) -> j = (r + 2) % 3; beside(r)
#ifdef LIVENESS
     :: overridden[r] && (!stands(r) || KEEPS_IT)
     :: !(overridden[r] || unnamed(r, (r + 1) % 3) || unnamed(r, (r + 2) % 3)) && !HAS_TO_DROP(r)
#else
     :: true
#endif
     fi
  :: !down[r] && !holds(r) ->
     if
     :: has_joined(r) && at[r] < END(r) -> plan(r)
#ifndef LIVENESS
     :: number[r] == 0
#endif
     :: !has_joined(r) || at[r] == END(r)
     fi
  fi
}

inline beside(r) {
  if
  :: j = 0; overridden[r] = true
#ifndef LIVENESS
  :: first[P(r,j)] = false; goto_name(r)
  :: first[P(r,j)] = true; goto_name(r)
#endif
  fi
}
inline goto_name(r) { d_step { name(r, true); number[r]++; j = 0 } }

#ifdef LIVENESS
#define may_choose(r, o) false
#else
#define may_choose(r, o) (heard_kind[P(r,o)] == WHOLE && (r) != A || (o) == B && heard_kind[P(r,o)] == WHOLE)
#endif
inline plan(r) {
  if
  :: first[P(r,(r + 1) % 3)] = false
  :: may_choose(r, (r + 1) % 3) -> first[P(r,(r + 1) % 3)] = true
  fi;
  if
  :: first[P(r,(r + 2) % 3)] = false
  :: may_choose(r, (r + 2) % 3) -> first[P(r,(r + 2) % 3)] = true
  fi;
  d_step {
  kind[r] = (r == A && number[A] == 0 -> NEAR : WHOLE);
  name(r, false);
  number[r]++; since[r] = number[r]; j = 0 }
}

#define ok(i, j) (clear_of(i, j, q))
inline decide(r) {
  if
  :: paused != r + 1 && !down[r] && holds(r) && !overridden[r] && may_leave_strip(r) && has_joined(r) ->
     q = at[r] + BRAKING(r);
     do
     :: q > to[r] && (q > strip_end(r) || !(others(r, ok))) -> q--
     :: q > to[r] && q <= strip_end(r) && others(r, ok) -> 
        to[r] = q; break
     :: q <= to[r] -> break
     od;
     q = 0
  :: else
  fi
}

inline forget(i, j) {
  heard[P(i,j)] = 0; heard_kind[P(i,j)] = NONE; heard_since[P(i,j)] = 0; heard_basis[P(i,j)] = 0; heard_first[P(i,j)] = false;
  basis[P(i,j)] = 0; first[P(i,j)] = false; told[P(i,j)] = 0; knows[P(i,j)] = 0; names[P(i,j)] = 0; confirmed[P(i,j)] = false;
  until[P(i,j)] = 0; given[P(i,j)] = 0; has_heard[P(i,j)] = false; seen_to[P(i,j)] = 0;
  age[P(i,j)] = (age[P(i,j)] == NEVER -> NEVER : OLD);
}
inline tidy(i, j) {
  if
  :: is_beyond(i, j) && age[P(j,i)] != NEVER -> forget(i, j); forget(j, i); seen_at[P(j,i)] = 0; seen_at[P(i,j)] = CROSS(j,i) + 1
  :: is_past(i, j) && is_past(j, i) && age[P(i,j)] != NEVER && age[P(j,i)] != NEVER -> forget(i, j); forget(j, i); seen_at[P(j,i)] = 0; seen_at[P(i,j)] = 0
  :: else
  fi
}

inline step() {
  i = 0;
  do
  :: i < 3 ->
     at[i] = (at[i] < to[i] -> at[i] + 1 : at[i]);
     j = 0;
     do
     :: j < 3 ->
        if
        :: i != j ->
           told[P(i,j)] = (down[i] -> 0 : heard[P(i,j)]);
           age[P(i,j)] = (age[P(i,j)] < OLD -> age[P(i,j)] + 1 : age[P(i,j)]);
           until[P(i,j)] = (until[P(i,j)] > 0 -> until[P(i,j)] - 1 : 0);
           if
           :: until[P(i,j)] == 0 -> given[P(i,j)] = 0; has_heard[P(i,j)] = false
           :: else
           fi
        :: else
        fi;
        j++
     :: else -> break
     od;
     i++
  :: else -> break
  od;
  tidy(A, B); tidy(B, A); tidy(A, C); tidy(C, A); tidy(B, C); tidy(C, B);
  i = 0; j = 0; lost = 0; paused = 0
}

active proctype fleet() {
  d_step {
    i = 0;
    do
    :: i < 9 -> age[i] = NEVER; i++
    :: else -> break
    od;
    i = 0
  }
  do
  :: atomic {
     network();
     d_step { hear(); note_who_heard(A); note_who_heard(B); note_who_heard(C) }
     reserve(A);
     reserve(B);
     reserve(C);
     d_step { note_who_heard(A); note_who_heard(B); note_who_heard(C) }
     decide(A);
     decide(B);
     decide(C);
     d_step {
     printf("A %d-%d #%d, B %d-%d #%d, C %d-%d #%d\n", at[A], to[A], number[A], at[B], to[B], number[B], at[C], to[C], number[C]);
     assert(!overlap(A, B));
     assert(!overlap(A, C));
     assert(!overlap(B, C));
     step() } }
  od
}

#ifdef LIVENESS
// Spin takes the conditional expression of END for an implication.
#define ALL_HOME (at[A] == 4 && at[B] == BRAKES + 1 && at[C] == 3)
#define FAIR (partition == 0 && late == 0 && !down[A] && !down[B] && !down[C])
ltl nobody_waits_for_ever { (<>[] FAIR) -> (<> ALL_HOME) }
#endif
