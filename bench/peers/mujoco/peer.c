// MuJoCo on the timing scene: a free body on three feet, the pusher a heavy sphere on a slide, set to its place and speed every step.
// Elliptic friction cones and impratio 10: with the default, pyramids and 1, the object ends up centimetres off and creeps 9 mm.
// All contacts lie in the plane of the table (box and spheres are centred at z = 0), so that they shift no weight between the feet.
// usage: peer SUBSTEPS; prints what compare.py reads.
#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const char *MODEL =
    "<mujoco><option cone='elliptic' impratio='10' timestep='%.17g' gravity='0 0 -9.81'/><worldbody>"
    "<geom type='plane' size='2 2 1' friction='.3' contype='1' conaffinity='1'/>"
    "<body><freejoint/><inertial pos='0 0 0' mass='.5' diaginertia='1.0416667e-4 1.0416667e-4 2.0833333333333335e-4'/>"
    "<geom type='box' size='.025 .025 .004' friction='.3' contype='2' conaffinity='2'/>"
    "<geom type='sphere' size='.001' pos='0 .02 .001' friction='.3' contype='1' conaffinity='1'/>"
    "<geom type='sphere' size='.001' pos='-.017320508075688773 -.01 .001' friction='.3' contype='1' conaffinity='1'/>"
    "<geom type='sphere' size='.001' pos='.017320508075688773 -.01 .001' friction='.3' contype='1' conaffinity='1'/></body>"
    "<body pos='-.032 -.0033 0'><joint type='slide' axis='1 0 0'/>"
    "<geom type='sphere' size='.005' mass='1000' friction='.3' contype='2' conaffinity='2'/></body>"
    "<geom type='sphere' size='.005' pos='.0794 .0591 0' friction='.3' contype='2' conaffinity='2'/>"
    "<geom type='sphere' size='.005' pos='.1203 -.0458 0' friction='.3' contype='2' conaffinity='2'/>"
    "<geom type='sphere' size='.005' pos='.0606 .0485 0' friction='.3' contype='2' conaffinity='2'/>"
    "</worldbody></mujoco>";

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * 1e9 + t.tv_nsec;
}

static void push(mjData *d, double time) {
  d->qpos[7] = 0.020 * fmin(time, 6.6);
  d->qvel[6] = time < 6.6 - 1e-9 ? 0.020 : 0;
}

int main(int argc, char **argv) {
  int substeps = argc > 1 ? atoi(argv[1]) : 1;
  double h = 1.0 / 30 / substeps;
  char xml[8192], error[500] = "";
  snprintf(xml, sizeof xml, MODEL, h);
  mjSpec *spec = mj_parseXMLString(xml, 0, error, sizeof error);
  mjModel *m = spec ? mj_compile(spec, 0) : 0;
  if (!m) return fprintf(stderr, "MuJoCo refused the model: %s\n", error), 1;
  mjData *d = mj_makeData(m);
  for (int round = 0; round < 2; round++) {
    mj_resetData(m, d);
    for (int frame = 0; frame < 600; frame++) {
      double start = now();
      for (int part = 0; part < substeps; part++) {
        push(d, (frame * substeps + part) * h);
        mj_step(m, d);
      }
      double taken = now() - start;
      if (!round) continue;
      printf("time %d %.1f\n", frame, taken);
      printf("pose %d %.12g %.12g %.12g\n", frame, d->qpos[0], d->qpos[1], 2 * atan2(d->qpos[6], d->qpos[3]));
    }
  }
  mj_resetData(m, d);
  d->qpos[0] = 1;  // away from pusher and fixels
  for (int k = 0; k < 30 * substeps; k++) push(d, 0), mj_step(m, d);
  double x = d->qpos[0], y = d->qpos[1];
  d->xfrc_applied[6] = 0.5 * 0.3 * 0.5 * 9.81;
  for (int k = 0; k < 150 * substeps; k++) push(d, 0), mj_step(m, d);
  printf("creep %.6g\n", hypot(d->qpos[0] - x, d->qpos[1] - y) * 1e3);
}
