#include "variant.h"

#include <string.h>

#include "scene.h"

/* What was fastest somewhere of many more. After a restart CVODES begins at order one: it takes a hundredth of the step
 * before; ARKODE, a one-step method, just goes on. */
static const Variant variants[] = {
    {.name = "klu", .family = BDF, .solver = BY_KLU},
    {.name = "cond", .family = BDF, .solver = BY_CONDENSATION},
    {"bdf", BDF, NULL, WHOLE, 1, 1, 0.1, 0, 0.01, 0},
    {"adams", ADAMS, NULL, WHOLE, 1, 1, 0.1, 0, 0.01, 0},
    {"ark2", DIRK, "ARKODE_TRBDF2_3_3_2", WHOLE, 1, 1, 300, 0, 0, 3},
    {"ark3", DIRK, "ARKODE_ESDIRK324L2SA_4_2_3", WHOLE, 1, 1, 100, 0, 0, 3},
    {"ark4", DIRK, "ARKODE_KVAERNO_5_3_4", WHOLE, 1, 1, 0.1, 0, 0, 3},
    {"ark4p", DIRK, "ARKODE_SDIRK_5_3_4", WHOLE, 1, 1, 0.1, 1, 0, 3},
    {"ark5", DIRK, "ARKODE_ESDIRK547L2SA2_7_4_5", WHOLE, 1, 1, 0.1, 1, 0, 4},
};

const Variant *variant_of(const char *name) {
  for (unsigned i = 0; i < sizeof variants / sizeof *variants; i++)
    if (!strcmp(variants[i].name, name)) return &variants[i];
  fail("no such variant: %s", name);
}
