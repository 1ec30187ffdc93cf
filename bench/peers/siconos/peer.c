// Siconos on the timing scene: each step's problem as 3-D friction contacts, solved by nonsmooth Gauss-Seidel (NSGS).
// A foot's normal row stands alone and carries a third of the weight; a side contact's third direction stands alone and carries nothing.
// usage: peer TOLERANCE; prints what compare.py reads.
#include <Friction_cst.h>
#include <FrictionContactProblem.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST = 7 };
static const double H = 1.0 / 30, M = 0.5, J = 2.0833333333333335e-4, MU = 0.3, G = 9.81, HALF = 0.025, RADIUS = 0.005, NEAR = 5e-3;
static double tolerance = 1e-8;
static SolverOptions *options;

typedef struct { double q[3], v[3], r[3 * MOST]; } Body;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * 1e9 + t.tv_nsec;
}

// Gap of a disc and the square; normal into the object, contact point on the object from its centre.
static double gap(const double q[3], double cx, double cy, double n[2], double arm[2]) {
  double c = cos(q[2]), s = sin(q[2]), dx = cx - q[0], dy = cy - q[1], x = c * dx + s * dy, y = -s * dx + c * dy;
  double px = fmax(-HALF, fmin(HALF, x)), py = fmax(-HALF, fmin(HALF, y)), ox = x - px, oy = y - py, d = hypot(ox, oy);
  if (d > 1e-12) {
    ox /= d, oy /= d;
  } else if (HALF - fabs(x) < HALF - fabs(y)) {
    d = fabs(x) - HALF, ox = x > 0 ? 1 : -1, oy = 0, px = ox * HALF;
  } else {
    d = fabs(y) - HALF, ox = 0, oy = y > 0 ? 1 : -1, py = oy * HALF;
  }
  n[0] = -(c * ox - s * oy), n[1] = -(s * ox + c * oy);
  arm[0] = c * px - s * py, arm[1] = s * px + c * py;
  return d - RADIUS;
}

static void row(double out[3], double ux, double uy, const double arm[2]) {
  out[0] = ux, out[1] = uy, out[2] = arm[0] * uy - arm[1] * ux;
}

static void step(Body *b, double px, double speed, double fx) {
  double rows[3 * MOST][3] = {{0}}, q[3 * MOST] = {0}, own[3 * MOST] = {0}, mu[MOST], v[3] = {b->v[0] + H * fx / M, b->v[1], b->v[2]};
  int contacts = 0, ids[MOST];
  double start[3 * MOST] = {0};
  for (int k = 0; k < 3; k++, contacts++) {
    double a = b->q[2] + M_PI_2 + k * 2 * M_PI / 3, arm[2] = {0.02 * cos(a), 0.02 * sin(a)};
    own[3 * k] = 1, q[3 * k] = -M * G * H / 3;
    row(rows[3 * k + 1], 1, 0, arm), row(rows[3 * k + 2], 0, 1, arm);
    mu[k] = MU, ids[k] = k;
  }
  double discs[4][3] = {{px, -0.0033, speed}, {0.0794, 0.0591, 0}, {0.1203, -0.0458, 0}, {0.0606, 0.0485, 0}};
  for (int k = 0; k < 4; k++) {
    double n[2], arm[2], psi = gap(b->q, discs[k][0], discs[k][1], n, arm);
    if (psi > NEAR) continue;
    int at = 3 * contacts;
    row(rows[at], n[0], n[1], arm), row(rows[at + 1], -n[1], n[0], arm);
    own[at + 2] = 1;
    q[at] = psi / H - n[0] * discs[k][2], q[at + 1] = n[1] * discs[k][2];
    mu[contacts] = MU, ids[contacts++] = 3 + k;
  }
  int size = 3 * contacts;
  double w[9 * MOST * MOST], mass[3] = {1 / M, 1 / M, 1 / J}, velocity[3 * MOST];
  for (int i = 0; i < size; i++) {
    for (int a = 0; a < 3; a++) q[i] += rows[i][a] * v[a];
    for (int j = 0; j < size; j++) {
      double sum = i == j ? own[i] : 0;
      for (int a = 0; a < 3; a++) sum += rows[i][a] * mass[a] * rows[j][a];
      w[i + size * j] = sum;
    }
  }
  for (int k = 0; k < contacts; k++) memcpy(start + 3 * k, b->r + 3 * ids[k], 3 * sizeof(double));
  NumericsMatrix *matrix = NM_create_from_data(NM_DENSE, size, size, w);
  FrictionContactProblem *problem = frictionContactProblem_new_with_data(3, contacts, matrix, q, mu);
  fc3d_driver(problem, start, velocity, options);
  for (int i = 0; i < size; i++)
    for (int a = 0; a < 3; a++) v[a] += mass[a] * rows[i][a] * start[i];
  memset(b->r, 0, sizeof b->r);
  for (int k = 0; k < contacts; k++) memcpy(b->r + 3 * ids[k], start + 3 * k, 3 * sizeof(double));
  matrix->matrix0 = 0;
  problem->q = problem->mu = 0;
  frictionContactProblem_free(problem);
  for (int a = 0; a < 3; a++) b->v[a] = v[a], b->q[a] += H * v[a];
}

int main(int argc, char **argv) {
  if (argc > 1) tolerance = atof(argv[1]);
  options = solver_options_create(SICONOS_FRICTION_3D_NSGS);
  options->dparam[SICONOS_DPARAM_TOL] = tolerance;
  options->iparam[SICONOS_IPARAM_MAX_ITER] = 100000;
  for (int round = 0; round < 2; round++) {
    Body b = {{0}};
    for (int frame = 0; frame < 600; frame++) {
      double start = now();
      step(&b, -0.032 + 0.020 * fmin(frame, 198) / 30, frame < 198 ? 0.020 : 0, 0);
      double taken = now() - start;
      if (round) printf("time %d %.1f\npose %d %.12g %.12g %.12g\n", frame, taken, frame, b.q[0], b.q[1], b.q[2]);
    }
  }
  Body b = {{1}};
  for (int k = 0; k < 150; k++) step(&b, -1, 0, 0.5 * MU * M * G);
  printf("creep %.6g\n", hypot(b.q[0] - 1, b.q[1]) * 1e3);
}
