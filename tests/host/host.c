/* Drives one of asperity's FMUs, unpacked, from C: loads the library, instantiates, initialises, steps, writes what it
   answers. Made for C99 on POSIX and Windows, with the official headers of FMI 2.0.

     host LIBRARY GUID RESOURCES INSTANCES POINTS COLUMN ... < MOTION > OUTPUTS

   MOTION: numbers, three a communication point: the time, u and w; the first POINTS of the points are used, 0 for all.
   Between them the carrier moves straight, and the FMU is told so, by the values at a point and the rates to the next.
   COLUMN: r or i, for a Real or an Integer, and a value reference. OUTPUTS: a line for each point, the columns with as
   many digits as it takes to read the same number back. INSTANCES: as many are made, run and freed, one after another;
   the first writes, the others do every step twice, from an FMU state that went through a byte string, and leave the
   last one to fmi2FreeInstance. How much memory the process took at most, after a tenth of them and at the end, is told where the
   system knows it. */
#if !defined(_WIN32)
#define _POSIX_C_SOURCE 200809L
#endif

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#include <sys/resource.h>
#endif

enum { INPUTS = 2, NAME_SIZE = 64 };

/* The inputs u and w are the first variables. */
static const fmi2ValueReference INPUT_REFERENCES[INPUTS] = {0, 1};
static const fmi2Integer FIRST_ORDER[INPUTS] = {1, 1};

typedef struct {
    double time;
    double place[INPUTS];
} Point;

typedef struct {
    Point *points;
    size_t count;
} Motion;

typedef struct {
    char kind;
    fmi2ValueReference reference;
} Column;

typedef struct {
    Column *columns;
    size_t count;
} Columns;

/* What of FMI 2.0 this host calls. */
typedef struct {
    fmi2InstantiateTYPE *instantiate;
    fmi2FreeInstanceTYPE *free_instance;
    fmi2SetupExperimentTYPE *setup_experiment;
    fmi2EnterInitializationModeTYPE *enter_initialization_mode;
    fmi2ExitInitializationModeTYPE *exit_initialization_mode;
    fmi2TerminateTYPE *terminate;
    fmi2SetRealTYPE *set_real;
    fmi2SetRealInputDerivativesTYPE *set_real_input_derivatives;
    fmi2GetRealTYPE *get_real;
    fmi2GetIntegerTYPE *get_integer;
    fmi2DoStepTYPE *do_step;
    fmi2GetFMUstateTYPE *get_state;
    fmi2SetFMUstateTYPE *set_state;
    fmi2FreeFMUstateTYPE *free_state;
    fmi2SerializedFMUstateSizeTYPE *serialized_size;
    fmi2SerializeFMUstateTYPE *serialize;
    fmi2DeSerializeFMUstateTYPE *deserialize;
} Functions;

static void stop(const char *what, const char *which) {
    fprintf(stderr, "host: %s: %s\n", what, which);
    exit(EXIT_FAILURE);
}

static void check(fmi2Status status, const char *call) {
    if (status != fmi2OK) {
        stop("not fmi2OK", call);
    }
}

static void *resized(void *memory, size_t size) {
    void *result = realloc(memory, size);
    if (!result) {
        stop("memory", "none left");
    }
    return result;
}

/* The library and its functions. */

typedef void (*Function)(void);

#if defined(_WIN32)
static void *open_library(const char *path) {
    HMODULE library = LoadLibraryA(path);
    if (!library) {
        stop("cannot load", path);
    }
    return library;
}

static void close_library(void *library) {
    FreeLibrary(library);
}

static Function find(void *library, const char *name) {
    Function function = (Function)GetProcAddress(library, name);
    if (!function) {
        stop("no function", name);
    }
    return function;
}

static void tell_memory(long instances) {
    (void)instances;
}
#else
static void *open_library(const char *path) {
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        stop("cannot load", dlerror());
    }
    return library;
}

static void close_library(void *library) {
    dlclose(library);
}

static Function find(void *library, const char *name) {
    Function function;
    void *symbol = dlsym(library, name);
    if (!symbol) {
        stop("no function", name);
    }
    /* ISO C knows no way from an object's address to a function's; POSIX does. */
    memcpy(&function, &symbol, sizeof function);
    return function;
}

static void tell_memory(long instances) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    fprintf(stderr, "host: %ld instances, at most %ld kB\n", instances, usage.ru_maxrss);
}
#endif

static Functions find_functions(void *library) {
    Functions fmi;
    fmi.instantiate = (fmi2InstantiateTYPE *)find(library, "fmi2Instantiate");
    fmi.free_instance = (fmi2FreeInstanceTYPE *)find(library, "fmi2FreeInstance");
    fmi.setup_experiment = (fmi2SetupExperimentTYPE *)find(library, "fmi2SetupExperiment");
    fmi.enter_initialization_mode = (fmi2EnterInitializationModeTYPE *)find(library, "fmi2EnterInitializationMode");
    fmi.exit_initialization_mode = (fmi2ExitInitializationModeTYPE *)find(library, "fmi2ExitInitializationMode");
    fmi.terminate = (fmi2TerminateTYPE *)find(library, "fmi2Terminate");
    fmi.set_real = (fmi2SetRealTYPE *)find(library, "fmi2SetReal");
    fmi.set_real_input_derivatives = (fmi2SetRealInputDerivativesTYPE *)find(library, "fmi2SetRealInputDerivatives");
    fmi.get_real = (fmi2GetRealTYPE *)find(library, "fmi2GetReal");
    fmi.get_integer = (fmi2GetIntegerTYPE *)find(library, "fmi2GetInteger");
    fmi.do_step = (fmi2DoStepTYPE *)find(library, "fmi2DoStep");
    fmi.get_state = (fmi2GetFMUstateTYPE *)find(library, "fmi2GetFMUstate");
    fmi.set_state = (fmi2SetFMUstateTYPE *)find(library, "fmi2SetFMUstate");
    fmi.free_state = (fmi2FreeFMUstateTYPE *)find(library, "fmi2FreeFMUstate");
    fmi.serialized_size = (fmi2SerializedFMUstateSizeTYPE *)find(library, "fmi2SerializedFMUstateSize");
    fmi.serialize = (fmi2SerializeFMUstateTYPE *)find(library, "fmi2SerializeFMUstate");
    fmi.deserialize = (fmi2DeSerializeFMUstateTYPE *)find(library, "fmi2DeSerializeFMUstate");
    return fmi;
}

/* What the FMU calls. */

static void log_message(
    fmi2ComponentEnvironment environment,
    fmi2String instance,
    fmi2Status status,
    fmi2String category,
    fmi2String message,
    ...
) {
    va_list arguments;
    fprintf((FILE *)environment, "%s: %s, status %d: ", instance, category, (int)status);
    va_start(arguments, message);
    vfprintf((FILE *)environment, message, arguments);
    va_end(arguments);
    fputc('\n', (FILE *)environment);
}

/* What the host reads and writes. */

static Motion read_motion(FILE *file, size_t limit) {
    Motion motion = {NULL, 0};
    Point point;
    while (fscanf(file, "%lf%lf%lf", &point.time, &point.place[0], &point.place[1]) == 3) {
        if (motion.count % 1024 == 0) {
            motion.points = resized(motion.points, (motion.count + 1024) * sizeof *motion.points);
        }
        motion.points[motion.count++] = point;
    }
    if (motion.count == 0 || !feof(file)) {
        stop("cannot read", "the motion");
    }
    if (limit > 0 && limit < motion.count) {
        motion.count = limit;
    }
    return motion;
}

static Columns read_columns(char **texts, size_t count) {
    Columns result = {NULL, count};
    size_t i;
    result.columns = resized(NULL, (count + 1) * sizeof *result.columns);
    for (i = 0; i < count; i++) {
        result.columns[i].kind = texts[i][0];
        result.columns[i].reference = (fmi2ValueReference)strtoul(texts[i] + 1, NULL, 10);
        if (texts[i][0] != 'r' && texts[i][0] != 'i') {
            stop("a column is r or i and a value reference, not", texts[i]);
        }
    }
    return result;
}

static void write_value(const Functions *fmi, fmi2Component component, const Column *column) {
    if (column->kind == 'r') {
        fmi2Real value;
        check(fmi->get_real(component, &column->reference, 1, &value), "fmi2GetReal");
        printf("%.17g", value);
    } else {
        fmi2Integer value;
        check(fmi->get_integer(component, &column->reference, 1, &value), "fmi2GetInteger");
        printf("%d", value);
    }
}

static void write_row(const Functions *fmi, fmi2Component component, const Columns *columns) {
    size_t i;
    for (i = 0; i < columns->count; i++) {
        if (i > 0) {
            putchar(',');
        }
        write_value(fmi, component, &columns->columns[i]);
    }
    putchar('\n');
}

/* A run. */

/* Where the carrier is at point i, and how fast it goes on to the next; after the last it rests. */
static void move(const Functions *fmi, fmi2Component component, const Motion *motion, size_t i) {
    const Point *here = &motion->points[i];
    double rates[INPUTS] = {0.0, 0.0};
    int axis;
    for (axis = 0; axis < INPUTS && i + 1 < motion->count; axis++) {
        rates[axis] = (here[1].place[axis] - here->place[axis]) / (here[1].time - here->time);
    }
    check(fmi->set_real(component, INPUT_REFERENCES, INPUTS, here->place), "fmi2SetReal");
    check(
        fmi->set_real_input_derivatives(component, INPUT_REFERENCES, INPUTS, FIRST_ORDER, rates),
        "fmi2SetRealInputDerivatives"
    );
}

static void initialise(const Functions *fmi, fmi2Component component, const Motion *motion) {
    double start = motion->points[0].time;
    double end = motion->points[motion->count - 1].time;
    check(fmi->setup_experiment(component, fmi2False, 0.0, start, fmi2True, end), "fmi2SetupExperiment");
    check(fmi->enter_initialization_mode(component), "fmi2EnterInitializationMode");
    move(fmi, component, motion, 0);
    check(fmi->exit_initialization_mode(component), "fmi2ExitInitializationMode");
}

static void step(const Functions *fmi, fmi2Component component, const Motion *motion, size_t i) {
    const Point *here = &motion->points[i];
    move(fmi, component, motion, i);
    check(fmi->do_step(component, here->time, here[1].time - here->time, fmi2True), "fmi2DoStep");
}

/* The state as it is when it has gone through a byte string. */
static fmi2FMUstate copy_of(const Functions *fmi, fmi2Component component, fmi2FMUstate state) {
    fmi2FMUstate copy = NULL;
    fmi2Byte *bytes;
    size_t size;
    check(fmi->serialized_size(component, state, &size), "fmi2SerializedFMUstateSize");
    bytes = resized(NULL, size);
    check(fmi->serialize(component, state, bytes, size), "fmi2SerializeFMUstate");
    check(fmi->deserialize(component, bytes, size, &copy), "fmi2DeSerializeFMUstate");
    free(bytes);
    return copy;
}

/* A step, done, undone and done again; the state gone back to is left. */
static void step_twice(const Functions *fmi, fmi2Component component, const Motion *motion, size_t i) {
    fmi2FMUstate before = NULL, copy;
    check(fmi->get_state(component, &before), "fmi2GetFMUstate");
    step(fmi, component, motion, i);
    copy = copy_of(fmi, component, before);
    check(fmi->free_state(component, &before), "fmi2FreeFMUstate");
    check(fmi->set_state(component, copy), "fmi2SetFMUstate");
    step(fmi, component, motion, i);
    if (i + 2 < motion->count) {
        check(fmi->free_state(component, &copy), "fmi2FreeFMUstate");
    }
}

/* One instance along the whole motion; without columns it writes nothing and does every step twice. */
static void run(const Functions *fmi, fmi2Component component, const Motion *motion, const Columns *columns) {
    size_t i;
    initialise(fmi, component, motion);
    for (i = 0; i < motion->count; i++) {
        if (i > 0 && columns) {
            step(fmi, component, motion, i - 1);
        } else if (i > 0) {
            step_twice(fmi, component, motion, i - 1);
        }
        if (columns) {
            write_row(fmi, component, columns);
        }
    }
    check(fmi->terminate(component), "fmi2Terminate");
}

static void run_instances(
    const Functions *fmi,
    const char *guid,
    const char *resources,
    long count,
    const Motion *motion,
    const Columns *columns
) {
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, stderr};
    char name[NAME_SIZE];
    long i;
    for (i = 0; i < count; i++) {
        fmi2Component component;
        snprintf(name, sizeof name, "instance %ld", i + 1);
        component = fmi->instantiate(name, fmi2CoSimulation, guid, resources, &callbacks, fmi2False, fmi2False);
        if (!component) {
            stop("not instantiated", name);
        }
        run(fmi, component, motion, i == 0 ? columns : NULL);
        fmi->free_instance(component);
        if (i + 1 == count / 10 || i + 1 == count) {
            tell_memory(i + 1);
        }
    }
}

int main(int count, char **arguments) {
    Motion motion;
    Columns columns;
    Functions fmi;
    void *library;
    if (count < 6) {
        stop("usage", "host LIBRARY GUID RESOURCES INSTANCES POINTS COLUMN ... < MOTION > OUTPUTS");
    }
    motion = read_motion(stdin, strtoul(arguments[5], NULL, 10));
    columns = read_columns(arguments + 6, (size_t)count - 6);
    library = open_library(arguments[1]);
    fmi = find_functions(library);
    run_instances(&fmi, arguments[2], arguments[3], strtol(arguments[4], NULL, 10), &motion, &columns);
    close_library(library);
    free(columns.columns);
    free(motion.points);
    return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
