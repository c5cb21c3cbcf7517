/* A program of somebody else's, compiled against the installed library: its only argument is a
 * scene file. Says what is wrong, or "all is well". */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wisplab.h>

static void must(int holds, const char *what) {
    if (holds)
        return;
    printf("not so: %s\n", what);
    exit(1);
}

/* Without damping and air. */
static const char *const conservative[] = {"material.drag_rate=0", "material.stretch_time=0",
                                           "material.bending_time=0", NULL};

static double total(wisplab *w, double t, const double *q, const double *v, double *parts) {
    double sum = 0;
    must(wisplab_energy(w, t, q, v, parts) == WISPLAB_OK, wisplab_error(w));
    for (int i = 0; i < wisplab_energies(); i++)
        sum += parts[i];
    return sum;
}

/* |a(x + h e_j) - a(x - h e_j)| / 2h against columns of M^-1 K and M^-1 D; M a column is K's or
 * D's.
 */
static void check_jacobian(wisplab *w, int n, const double *q, const double *v) {
    const size_t size = (size_t)n * sizeof(double);
    const double h = 1e-7;
    double *x = malloc(size), *ahead = malloc(size), *behind = malloc(size),
           *product = malloc(size), *matrix = malloc((size_t)n * size);
    must(wisplab_linearise(w, WISPLAB_EXACT, 0.1, q, v) == WISPLAB_OK, wisplab_error(w));
    for (int of_velocity = 0; of_velocity < 2; of_velocity++) {
        must(wisplab_dense(w, 0, of_velocity, !of_velocity, matrix) == WISPLAB_OK, "dense");
        for (int j = 0; j < n; j++) {
            const double *from = of_velocity ? v : q;
            double most = 0, error = 0;
            memcpy(x, from, size);
            x[j] = from[j] + h;
            wisplab_acceleration(w, 0.1, of_velocity ? q : x, of_velocity ? x : v, ahead);
            x[j] = from[j] - h;
            wisplab_acceleration(w, 0.1, of_velocity ? q : x, of_velocity ? x : v, behind);
            for (int i = 0; i < n; i++)
                x[i] = (ahead[i] - behind[i]) / (2 * h);
            must(wisplab_product(w, 1, 0, 0, x, product) == WISPLAB_OK, "product");
            for (int i = 0; i < n; i++) {
                most = fmax(most, fabs(matrix[j * n + i]));
                error = fmax(error, fabs(matrix[j * n + i] - product[i]));
            }
            must(error <= 1e-6 * most, "the exact Jacobian is the derivative");
        }
    }
    free(x), free(ahead), free(behind), free(product), free(matrix);
}

/* E along the motion has no first derivative; its kinetic part is v'Mv / 2. */
static void check_energy(wisplab *w, int n, const double *q, const double *v) {
    const size_t size = (size_t)n * sizeof(double);
    const double h = 1e-6;
    double *a = malloc(size), *x = malloc(size), *u = malloc(size), parts[16], sides[2][16],
           twice = 0;
    double power = 0;
    must(wisplab_energies() <= 16 && strcmp(wisplab_energy_name(0), "kinetic") == 0, "energies");
    total(w, 0, q, v, parts);
    must(wisplab_linearise(w, WISPLAB_SPD, 0, q, v) == WISPLAB_OK, wisplab_error(w));
    must(wisplab_product(w, 1, 0, 0, v, x) == WISPLAB_OK, "product");
    for (int i = 0; i < n; i++)
        twice += v[i] * x[i];
    must(fabs(parts[0] - twice / 2) <= 1e-12 * parts[0], "kinetic energy is v'Mv / 2");
    must(wisplab_acceleration(w, 0, q, v, a) == WISPLAB_OK, wisplab_error(w));
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < n; i++) {
            x[i] = q[i] + (side ? h : -h) * v[i];
            u[i] = v[i] + (side ? h : -h) * a[i];
        }
        total(w, 0, x, u, sides[side]);
    }
    double change = 0;
    for (int k = 0; k < wisplab_energies(); k++) {
        change += sides[1][k] - sides[0][k];
        power = fmax(power, fabs(sides[1][k] - sides[0][k]));
    }
    must(power > 0 && fabs(change) <= 1e-6 * power, "energy is conserved");
    free(a), free(x), free(u);
}

int main(int count, char **arguments) {
    char error[400] = "";
    wisplab *w = NULL;
    double t, begin, end, rate;
    must(count == 2, "one argument");
    must(wisplab_open(&w, "no-such-scene", NULL, NULL, error, sizeof error) == WISPLAB_REFUSED &&
             !w && strstr(error, "no-such-scene"),
         "an unknown scene is refused by name");
    must(wisplab_open(&w, arguments[1], conservative, NULL, error, sizeof error) == WISPLAB_OK,
         error);
    const int n = wisplab_unknowns(w);
    double *q = malloc((size_t)n * sizeof *q), *v = malloc((size_t)n * sizeof *v),
           *a = malloc((size_t)n * sizeof *a);
    struct wisplab_unknown what;
    wisplab_state(w, &t, q, v);
    wisplab_times(w, &begin, &end, &rate);
    must(t == begin && end > begin && wisplab_wisps(w) == 1, "it is the scene");
    must(wisplab_unknown(w, n - 1, &what) == WISPLAB_OK && strcmp(what.name, "z") == 0 &&
             strcmp(what.unit, "m") == 0 && what.node == n / 3 + 1,
         "the last unknown is z of the last node");
    must(wisplab_unknown(w, n, &what) == WISPLAB_REFUSED, "and there is none behind it");
    must(wisplab_acceleration(w, t, q, v, a) == WISPLAB_OK, wisplab_error(w));
    for (int i = 0; i < n; i++)
        must(fabs(a[i] - (i % 3 == 1 ? -9.81 : 0)) < 1e-9, "at rest, what is let go falls");
    for (int i = 0; i < n; i++) {
        q[i] += 1e-3 * sin(3 * i);
        v[i] = cos(5 * i);
    }
    check_jacobian(w, n, q, v);
    check_energy(w, n, q, v);
    must(wisplab_linearise(w, WISPLAB_EXACT, t, q, v) == WISPLAB_OK &&
             wisplab_factor(w, 0, 0) == WISPLAB_REFUSED && *wisplab_error(w),
         "what cannot be factorised is refused, with a text");
    wisplab_close(w);
    must(wisplab_open(&w, "circle", NULL, NULL, error, sizeof error) == WISPLAB_OK, error);
    must(wisplab_run(w, &(struct wisplab_method){.stepper = "rk4"}, 1) == WISPLAB_OK,
         wisplab_error(w));
    wisplab_close(w);
    free(q), free(v), free(a);
    puts("all is well");
    return 0;
}
