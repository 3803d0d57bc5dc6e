/* A finite-strain behaviour of MFront's "generic" interface around an Abaqus UMAT, without MFront.

   The file that includes this one defines BEHAVIOUR (prefix of all symbols), UMAT (the routine), NTENS (6 or 4), N_PROPS,
   N_STATEV, HOST_START (whether the host's gradient of the start is taken, in place of the point's own). Units are the UMAT's. Orders of components: UMAT and symmetric tensors 11 22 33 12 13 23 (the host's with the
   shears times sqrt 2), full tensors 11 22 33 12 21 13 31 23 32; 4 and 5 of them in a plane. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
enum { N_TENSOR = NTENS == 6 ? 9 : 5, MESSAGE = 512 };
static const int ROW[9] = {0, 1, 2, 0, 1, 0, 2, 1, 2}, COL[9] = {0, 1, 2, 1, 0, 2, 0, 2, 1};
static const int SYM_ROW[6] = {0, 1, 2, 0, 0, 1}, SYM_COL[6] = {0, 1, 2, 1, 2, 2};
static const double ROOT_2 = 1.41421356237309504880, NO_OPINION = 1.0e36;

/* What the host hands over, version 1 of the interface: the states at both ends of an increment, and the point. */
typedef struct {
  const double *gradients;
  double *thermodynamic_forces;
  const double *mass_density, *material_properties;
  double *internal_state_variables, *stored_energy, *dissipated_energy;
  const double *external_state_variables;
} State;
typedef struct {
  char *error_message;
  double dt, *K, *rdt, *speed_of_sound;
  State s0, s1;
} Point;
typedef double Tensor[3][3];
typedef enum { CAUCHY, SECOND_PIOLA_KIRCHHOFF, FIRST_PIOLA_KIRCHHOFF } Measure;

extern void UMAT(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
                 double *ddsddt, double *drplde, double *drpldt, double *stran, double *dstran, double *time, double *dtime,
                 double *temp, double *dtemp, double *predef, double *dpred, char *cmname, int *ndi, int *nshr, int *ntens,
                 int *nstatv, double *props, int *nprops, double *coords, double *drot, double *pnewdt, double *celent,
                 double *dfgrd0, double *dfgrd1, int *noel, int *npt, int *layer, int *kspt, int *kstep, int *kinc,
                 size_t cmname_length);
extern int plyflow_standin_take(int *stop, char *text, int length);

static double scale(int i) { return i < 3 ? 1.0 : ROOT_2; }

static void full(const double *components, Tensor a) {
  memset(a, 0, sizeof(Tensor));
  for (int k = 0; k < N_TENSOR; ++k) a[ROW[k]][COL[k]] = components[k];
}

static void symmetric(const double *components, Tensor a) {
  memset(a, 0, sizeof(Tensor));
  for (int k = 0; k < NTENS; ++k) a[SYM_ROW[k]][SYM_COL[k]] = a[SYM_COL[k]][SYM_ROW[k]] = components[k] / scale(k);
}

/* c = a b, a b^T, a^T b by whether a, b are transposed. */
static void product(Tensor a, int turn_a, Tensor b, int turn_b, Tensor c) {
  Tensor result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      result[i][j] = 0.0;
      for (int k = 0; k < 3; ++k) result[i][j] += (turn_a ? a[k][i] : a[i][k]) * (turn_b ? b[j][k] : b[k][j]);
    }
  memcpy(c, result, sizeof(Tensor));
}

static double inverse(Tensor a, Tensor b) {
  double det = 0.0;
  for (int j = 0; j < 3; ++j) {
    int k = (j + 1) % 3, m = (j + 2) % 3;
    for (int i = 0; i < 3; ++i) {
      int n = (i + 1) % 3, p = (i + 2) % 3;
      b[j][i] = a[n][k] * a[p][m] - a[n][m] * a[p][k];
    }
    det += a[0][j] * b[j][0];
  }
  for (int i = 0; i < 9; ++i) (&b[0][0])[i] /= det;
  return det;
}

/* Cauchy stress from the host's measure at a deformation gradient f. */
static void cauchy_of(Measure measure, const double *force, Tensor f, Tensor sigma) {
  Tensor unused;
  double det = inverse(f, unused);
  if (measure == FIRST_PIOLA_KIRCHHOFF) full(force, sigma);
  else symmetric(force, sigma);
  if (measure == CAUCHY) return;
  if (measure == SECOND_PIOLA_KIRCHHOFF) product(f, 0, sigma, 0, sigma);
  product(sigma, 0, f, 1, sigma);
  for (int i = 0; i < 9; ++i) (&sigma[0][0])[i] /= det;
}

/* The stress in the host's measure: sigma, J F^-1 sigma F^-T or J sigma F^-T; g = F^-1, tau = J sigma. */
static void force_of(Measure measure, Tensor tau, double det, Tensor g, double *force) {
  Tensor a;
  memcpy(a, tau, sizeof(Tensor));
  if (measure != CAUCHY) product(a, 0, g, 1, a);
  if (measure == SECOND_PIOLA_KIRCHHOFF) product(g, 0, a, 0, a);
  if (measure == FIRST_PIOLA_KIRCHHOFF)
    for (int k = 0; k < N_TENSOR; ++k) force[k] = a[ROW[k]][COL[k]];
  else
    for (int k = 0; k < NTENS; ++k) force[k] = scale(k) * a[SYM_ROW[k]][SYM_COL[k]] / (measure == CAUCHY ? det : 1.0);
}

/* Change of the Kirchhoff stress with the velocity gradient l: J DDSDDE : D + W tau - tau W (DDSDDE by columns). */
static void kirchhoff_rate(const double *ddsdde, Tensor tau, double det, Tensor l, Tensor rate) {
  Tensor spin, left, right;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) spin[i][j] = 0.5 * (l[i][j] - l[j][i]);
  product(spin, 0, tau, 0, left);
  product(tau, 0, spin, 0, right);
  for (int i = 0; i < 9; ++i) (&rate[0][0])[i] = (&left[0][0])[i] - (&right[0][0])[i];
  for (int i = 0; i < NTENS; ++i) {
    double sum = 0.0;
    int r = SYM_ROW[i], c = SYM_COL[i];
    for (int k = 0; k < NTENS; ++k) {
      double strain = l[SYM_ROW[k]][SYM_COL[k]] + (k < 3 ? 0.0 : l[SYM_COL[k]][SYM_ROW[k]]);
      sum += ddsdde[k * NTENS + i] * strain;
    }
    rate[r][c] += det * sum;
    if (r != c) rate[c][r] += det * sum;
  }
}

/* Rows by forces, columns by strains: d sigma/dF, dS/dE or dP/dF as K[2] chooses; the host's operator is stored by rows. */
static void tangent(Measure operator, const double *ddsdde, Tensor tau, double det, Tensor g, double *K) {
  int columns = operator == SECOND_PIOLA_KIRCHHOFF ? NTENS : N_TENSOR;
  int rows = operator == FIRST_PIOLA_KIRCHHOFF ? N_TENSOR : NTENS;
  for (int k = 0; k < columns; ++k) {
    Tensor l, rate, turned;
    double change[9];
    memset(l, 0, sizeof(Tensor));
    if (operator == SECOND_PIOLA_KIRCHHOFF) {
      l[SYM_ROW[k]][SYM_COL[k]] = l[SYM_COL[k]][SYM_ROW[k]] = 1.0 / scale(k);
      product(g, 1, l, 0, l);
    } else
      l[ROW[k]][COL[k]] = 1.0;
    product(l, 0, g, 0, l);
    kirchhoff_rate(ddsdde, tau, det, l, rate);
    for (int side = 0; side < 2; ++side) { /* what the pull-back takes off: tau L^T for P, L tau as well for S */
      if (operator == CAUCHY || (operator == FIRST_PIOLA_KIRCHHOFF && side == 1)) continue;
      if (side == 0) product(tau, 0, l, 1, turned);
      else product(l, 0, tau, 0, turned);
      for (int i = 0; i < 9; ++i) (&rate[0][0])[i] -= (&turned[0][0])[i];
    }
    if (operator == CAUCHY)
      for (int i = 0; i < 9; ++i) (&rate[0][0])[i] -= (&tau[0][0])[i] * (l[0][0] + l[1][1] + l[2][2]);
    force_of(operator, rate, det, g, change);
    for (int i = 0; i < rows; ++i) K[i * columns + k] = change[i];
  }
}

static int refuse(Point *d, const char *text) {
  fprintf(stderr, "%s\n", text);
  if (d->error_message) snprintf(d->error_message, MESSAGE, "%s", text);
  return -1;
}

static int choice(double flag) { return flag < 0.5 ? 0 : flag < 1.5 ? 1 : flag < 2.5 ? 2 : 3; }

/* One increment of one point. K[0]: below -0.5 the tangent at the start alone, around 0 the stress alone, else stress and
   consistent tangent (elastic and secant operators are not told from it). K[1], K[2]: stress and operator, see `Measure`.
   1: done; -1: the UMAT asked for a smaller increment (its ratio in rdt) or for the end, its words in error_message. */
static int integrate(Point *d) {
  double wanted = d->K[0], pnewdt = NO_OPINION, stress[6], statev[N_STATEV + 1], ddsdde[NTENS * NTENS] = {0.0};
  double energies[3] = {0.0}, zeros[9] = {0.0}, time[2] = {0.0}, temp = 0.0, dtemp = 0.0, unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double heat[2] = {0.0}, thermal[2 * NTENS] = {0.0}, strains[2 * NTENS] = {0.0}, props[N_PROPS + 1], f0[9], f1[9], celent = 0.0;
  int ndi = 3, nshr = NTENS - 3, ntens = NTENS, nstatv = N_STATEV, nprops = N_PROPS, one = 1, smooth = 2, stop = 0;
  char name[81], said[4096] = "";
  Tensor start, end, sigma, tau, g;
  int measure = choice(d->K[1]), operator = choice(d->K[2]), predict = wanted < -0.5;
  if (wanted > 50.0) return refuse(d, BEHAVIOUR_NAME ": no speed of sound is computed; do not ask for it (K[0] above 50)");
  if (measure > 2 || operator > 2)
    return refuse(d, BEHAVIOUR_NAME ": K[1] is 0, 1, 2 (Cauchy, PK2, PK1) and K[2] is 0, 1, 2 (dsig_dF, dPK2_dEGL, dPK1_dF)");
  /* The last F that this point saw, all zero for none. s0.gradients is another in hosts that average the volume ratio for s1. */
  const double *kept = d->s0.internal_state_variables + N_STATEV, undeformed[9] = {1.0, 1.0, 1.0};
  const double *from = HOST_START ? d->s0.gradients : kept[0] != 0.0 ? kept : undeformed;
  full(from, start);
  full(predict ? from : d->s1.gradients, end);
  for (int i = 0; i < 9; ++i) { /* the UMAT reads columns */
    f0[i] = start[i % 3][i / 3];
    f1[i] = end[i % 3][i / 3];
  }
  cauchy_of(measure, d->s0.thermodynamic_forces, start, sigma);
  for (int k = 0; k < NTENS; ++k) stress[k] = sigma[SYM_ROW[k]][SYM_COL[k]];
  memcpy(statev, d->s0.internal_state_variables, N_STATEV * sizeof(double));
  memcpy(props, d->s1.material_properties, N_PROPS * sizeof(double));
  if (d->s0.external_state_variables && d->s1.external_state_variables) {
    temp = d->s0.external_state_variables[0];
    dtemp = d->s1.external_state_variables[0] - temp;
  }
  if (d->s0.stored_energy) energies[0] = *d->s0.stored_energy;
  if (d->s0.dissipated_energy) energies[2] = *d->s0.dissipated_energy;
  memset(name, ' ', sizeof name);
  memcpy(name, BEHAVIOUR_NAME, strlen(BEHAVIOUR_NAME));
  UMAT(stress, statev, ddsdde, energies, energies + 1, energies + 2, heat, thermal, thermal + NTENS, heat + 1, strains,
       strains + NTENS, time, &d->dt, &temp, &dtemp, zeros, zeros, name, &ndi, &nshr, &ntens, &nstatv, props, &nprops, zeros,
       unit, &pnewdt, &celent, f0, f1, &one, &one, &one, &one, &one, &smooth, (size_t)80);
  plyflow_standin_take(&stop, said, (int)sizeof said);
  if (stop || pnewdt < 1.0) {
    if (d->rdt && pnewdt < 1.0) *d->rdt = pnewdt;
    return refuse(d, said[0] ? said : BEHAVIOUR_NAME ": the UMAT asked for a smaller increment");
  }
  if (said[0]) fprintf(stderr, "%s\n", said);
  double det = inverse(end, g);
  for (int k = 0; k < NTENS; ++k) {
    if (!(fabs(stress[k]) <= DBL_MAX)) return refuse(d, BEHAVIOUR_NAME ": the UMAT returned a stress that is not finite");
    tau[SYM_ROW[k]][SYM_COL[k]] = tau[SYM_COL[k]][SYM_ROW[k]] = det * stress[k];
  }
  for (int k = NTENS; k < 6; ++k) tau[SYM_ROW[k]][SYM_COL[k]] = tau[SYM_COL[k]][SYM_ROW[k]] = 0.0;
  if (predict || wanted > 0.5) tangent(operator, ddsdde, tau, det, g, d->K);
  if (predict) return 1;
  force_of(measure, tau, det, g, d->s1.thermodynamic_forces);
  memcpy(d->s1.internal_state_variables, statev, N_STATEV * sizeof(double));
  memcpy(d->s1.internal_state_variables + N_STATEV, d->s1.gradients, N_TENSOR * sizeof(double));
  if (d->s1.stored_energy) *d->s1.stored_energy = energies[0];
  if (d->s1.dissipated_energy) *d->s1.dissipated_energy = energies[1] + energies[2];
  return 1;
}

/* Components of a tensor in the other basis; r has the material axes as columns, stored by rows. */
static void turn(const double *from, const double *r, int full_tensor, int back, double *to) {
  Tensor a, q;
  memcpy(q, r, sizeof(Tensor));
  if (full_tensor) full(from, a);
  else symmetric(from, a);
  product(q, !back, a, 0, a);
  product(a, 0, q, back, a);
  if (full_tensor)
    for (int k = 0; k < N_TENSOR; ++k) to[k] = a[ROW[k]][COL[k]];
  else
    for (int k = 0; k < NTENS; ++k) to[k] = scale(k) * a[SYM_ROW[k]][SYM_COL[k]];
}

/* An operator turned back: both bases are orthonormal, so columns and rows turn as their tensors do. */
static void turn_operator(const double *from, const double *r, int full_rows, int full_columns, double *to) {
  double one[9], made[81];
  int rows = full_rows ? N_TENSOR : NTENS, columns = full_columns ? N_TENSOR : NTENS;
  for (int k = 0; k < columns; ++k) {
    for (int i = 0; i < rows; ++i) one[i] = from[i * columns + k];
    turn(one, r, full_rows, 1, one);
    for (int i = 0; i < rows; ++i) made[i * columns + k] = one[i];
  }
  for (int i = 0; i < rows; ++i) turn(made + i * columns, r, full_columns, 1, to + i * columns);
}

/* The symbols of a modelling hypothesis: the function, and rotations of one point and of n (to, from, r[, n]). */
#define NAMED(a, b, c) a##_##b##c
#define SYMBOL(behaviour, hypothesis, what) NAMED(behaviour, hypothesis, what)
#define EACH(name, array, count, one)                                                              \
  EXPORT void name(double *to, const double *from, const double *r) { one; }                       \
  EXPORT void array(double *to, const double *from, const double *r, size_t n) {                   \
    for (size_t p = 0; p < n; ++p, to += (count), from += (count)) { one; }                        \
  }
#define ROTATION(h, what, suffix, count, one)                                                      \
  EACH(SYMBOL(BEHAVIOUR, h, _rotate##what##suffix), SYMBOL(BEHAVIOUR, h, _rotateArrayOf##what##suffix), count, one)
#define HYPOTHESIS(h)                                                                              \
  EXPORT int SYMBOL(BEHAVIOUR, h, )(Point * d) { return integrate(d); }                            \
  ROTATION(h, Gradients, , N_TENSOR, turn(from, r, 1, 0, to))                                      \
  ROTATION(h, ThermodynamicForces, _CauchyStress, NTENS, turn(from, r, 0, 1, to))                  \
  ROTATION(h, ThermodynamicForces, _PK2Stress, NTENS, turn(from, r, 0, 1, to))                     \
  ROTATION(h, ThermodynamicForces, _PK1Stress, N_TENSOR, turn(from, r, 1, 1, to))                  \
  ROTATION(h, TangentOperatorBlocks, _dsig_dF, NTENS * N_TENSOR, turn_operator(from, r, 0, 1, to)) \
  ROTATION(h, TangentOperatorBlocks, _dPK2_dEGL, NTENS * NTENS, turn_operator(from, r, 0, 0, to))  \
  ROTATION(h, TangentOperatorBlocks, _dPK1_dF, N_TENSOR * N_TENSOR, turn_operator(from, r, 1, 1, to))
