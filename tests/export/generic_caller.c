// Calls every function of a compiled model by what its interface document says, and by nothing else.
//
//     generic_caller LIBRARY INTERFACE.json VALUES.json
//
// VALUES.json: {"names": [...], "values": [...]}; a parameter that it does not name has its default, all else is 0.
// A line for every output: function, output, then all elements in the order of the document.

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Node {
    char kind; // { [ " 0 (a number), n (null, true or false)
    char *key, *text;
    double number;
    size_t count;
    struct Node *first, *next;
} Node;

typedef int Entry(int, const double *const *, double *const *);

static void fail(const char *what)
{
    fprintf(stderr, "%s\n", what);
    exit(1);
}

static char *at;

static void skip(void)
{
    at += strspn(at, " \t\r\n,:");
}

static char *quoted(void)
{
    char *result = ++at, *to = at;
    while (*at && *at != '"') {
        if (*at == '\\' && *++at == 'u') fail("no such escape is expected");
        *to++ = *at++;
    }
    ++at;
    *to = 0;
    return result;
}

static Node *value(void)
{
    Node *node = calloc(1, sizeof(Node)), **last = &node->first;
    skip();
    node->kind = *at;
    if (*at == '{' || *at == '[') {
        const char closing = *at++ == '{' ? '}' : ']';
        for (skip(); *at != closing; skip()) {
            char *key = closing == '}' ? quoted() : NULL;
            *last = value();
            (*last)->key = key;
            last = &(*last)->next;
            ++node->count;
        }
        ++at;
    } else if (*at == '"') {
        node->text = quoted();
    } else if (strchr("ntf", *at)) {
        at += strspn(at, "nulltruefalse");
    } else {
        char *end;
        node->kind = '0';
        node->number = strtod(at, &end);
        if (end == at) fail("this is no JSON");
        at = end;
    }
    return node;
}

static Node *read_json(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file) fail(path);
    fseek(file, 0, SEEK_END);
    const size_t size = (size_t)ftell(file);
    rewind(file);
    at = calloc(size + 1, 1);
    if (fread(at, 1, size, file) != size) fail(path);
    fclose(file);
    return value();
}

static Node *member(const Node *node, const char *key)
{
    for (Node *each = node ? node->first : NULL; each; each = each->next)
        if (each->key && !strcmp(each->key, key)) return each;
    return NULL;
}

static Node *needed(const Node *node, const char *key)
{
    Node *found = member(node, key);
    if (!found) fail(key);
    return found;
}

static double given(const Node *values, const char *name, const Node *initial)
{
    const Node *x = needed(values, "values")->first;
    for (const Node *n = needed(values, "names")->first; n; n = n->next, x = x->next)
        if (!strcmp(n->text, name)) return x->number;
    return initial && initial->kind == '0' ? initial->number : 0.0;
}

// the numbers of an argument, in the order of its names
static double *column(const Node *vector, const Node *values)
{
    if (!vector) return NULL;
    double *result = calloc(needed(vector, "names")->count + 1, sizeof(double)), *to = result;
    const Node *defaults = member(vector, "defaults"), *initial = defaults ? defaults->first : NULL;
    for (const Node *n = needed(vector, "names")->first; n; n = n->next) {
        *to++ = given(values, n->text, initial);
        if (initial) initial = initial->next;
    }
    return result;
}

static size_t elements(const Node *output)
{
    size_t result = 1;
    for (const Node *n = needed(output, "shape")->first; n; n = n->next) result *= (size_t)n->number;
    return result;
}

static void call(Entry *entry, int number, const Node *function, const Node *told, const Node *values)
{
    const Node *order = needed(needed(told, "call"), "vectors"), *outputs = needed(function, "outputs");
    const double **in = calloc(order->count, sizeof(double *));
    double **out = calloc(outputs->count, sizeof(double *));
    size_t k = 0;
    for (const Node *symbol = order->first; symbol; symbol = symbol->next) {
        const Node *own = member(function, symbol->text);
        in[k++] = column(own ? own : member(needed(told, "vectors"), symbol->text), values);
    }
    k = 0;
    for (const Node *output = outputs->first; output; output = output->next)
        out[k++] = calloc(elements(output) + 1, sizeof(double));
    if (entry(number, in, out)) fail("there is no such function");
    k = 0;
    for (const Node *output = outputs->first; output; output = output->next, ++k) {
        printf("%s %s", needed(function, "name")->text, needed(output, "name")->text);
        for (size_t i = 0; i < elements(output); ++i) printf(" %.17g", out[k][i]);
        printf("\n");
    }
}

int main(int count, char **arguments)
{
    if (count != 4) fail("generic_caller LIBRARY INTERFACE.json VALUES.json");
    void *library = dlopen(arguments[1], RTLD_NOW), *symbol;
    if (!library) fail(dlerror());
    const Node *told = read_json(arguments[2]), *values = read_json(arguments[3]);
    Entry *entry;
    symbol = dlsym(library, needed(needed(told, "call"), "name")->text);
    if (!symbol) fail(dlerror());
    memcpy(&entry, &symbol, sizeof entry);
    int number = 0;
    for (const Node *each = needed(told, "functions")->first; each; each = each->next)
        call(entry, number++, each, told, values);
    return 0;
}
