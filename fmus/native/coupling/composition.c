/* What a composite is made of: its coupling, its parts with the tokens of their own, where they are and
   what they start from.  An FMU keeps the text among its resources; its GUID or instantiation token
   is the identity alone, Composite/<hash of the text>, which tools use as a name of files.

       Composite;corners=2;part=rotor,0,-,RotorOnSupports/...;start=0:4028000000000000;
       part=balls,1,s,BallBalancer/...;own=0:3f1a36e2eb1c432d

   `corners` of a speed profile behind its first rise and `changes` of the unbalance: how many.  A part: name, plane of the rotor from 1, s where it exchanges force and v where it follows its plane's
   place, token.  The rotor is the first part and a motor the last; both have plane 0 and no letters.
   `start` and `flags` are of the part before them, as fmi/unit_token.h has them; `own` are the start values of
   the composite's own variables, from the tolerance on. */
#include <string.h>

#include "coupling/composite.h"

enum { NAME_SIZE = 128, MOST_UNITS = 250 };

/* What a composition counts. */
static const Count CORNERS = {"corners", 0, 10000}, CHANGES = {"changes", 0, 10000},
                   PLANE = {"plane", 0, 1000};

bool composite_named(const char *token)
{
    return token && text_after(token, "Composite;");
}

static int refuse_composition(Unit *unit, const char *why)
{
    return unit_fail(unit, "identity of a composite: %s", why);
}

/* A part's own message under the composite's name. */
static void forward(void *host, const char *name, Status status, const char *message)
{
    Unit *unit = host;
    Text text = text_in(unit->message_buffer, sizeof unit->message_buffer);
    text_format(&text, "%s: %s", unit->name, message);
    unit->log(unit->host, unit->name, status, text.at);
}

/* Value reference of a part's variable, or -1. */
static int reference(const Unit *part, const char *name)
{
    const size_t found = layout_index(&part->layout, name, 1);
    return found < part->layout.real_count ? (int)found : -1;
}

static bool has_letter(const char *word, char letter)
{
    while (*word && *word != letter) {
        word++;
    }
    return *word == letter;
}

/* Make the unit of a part; where the text goes on, or NULL with the reason. */
static const char *make_part(Unit *unit, Part *part, const char *name, const char *text)
{
    Unit *made = unit_allocate(unit, 1, sizeof *made);
    int wrong;
    if (!made) {
        refuse_composition(unit, "there is not enough memory");
        return NULL;
    }
    part->unit = made;
    made->log = forward;
    made->host = unit;
    made->allocated = unit->allocated;
    wrong = unit_build(made, name, text, &text);
    unit->allocated = made->allocated; /* what it needs goes with the composite */
    if (wrong) {
        refuse_composition(unit, made->reason.at);
    }
    return wrong ? NULL : text;
}

/* "name,plane,connections,token" and its start values; composition.py has checked what is where.  Where
   the text goes on, or NULL with the reason. */
static const char *read_part(Unit *unit, Part *part, const char *at)
{
    Composite *c = unit->own;
    char name[NAME_SIZE], connections[4], words[REASON_SIZE];
    Text why = text_in(words, sizeof words);
    const int first = part == c->parts;
    bool is_motor, is_mounted;
    int plane = 0;
    at = token_word(at, ',', name, sizeof name);
    at = at ? token_count(&PLANE, at, ',', &plane, &why) : NULL;
    at = at ? token_word(at, ',', connections, sizeof connections) : NULL;
    if (!at) {
        refuse_composition(unit, why.length ? words : "a part must be name, plane, connections, token");
        return NULL;
    }
    at = make_part(unit, part, name, at);
    if (!at) {
        return NULL;
    }
    is_motor = part->unit->equations == &MOTOR_EQUATIONS;
    is_mounted = !first && !is_motor;
    if (first != (part->unit->equations == &ROTOR_EQUATIONS) || c->motor ||
        part->unit->layout.sizes.fixed_frame ||
        (is_mounted && (plane < 1 || plane > c->parts->unit->layout.sizes.planes))) {
        refuse_composition(unit, "its parts must be a rotor, balancers on its planes and at "
                           "most one motor, with signals that turn with the rotor");
        return NULL;
    }
    c->motor = is_motor ? part : NULL;
    c->parts_without_motor += !is_motor;
    part->plane = plane - 1;
    part->speed_input = is_motor ? -1 : reference(part->unit, "speed");
    part->place = is_mounted && has_letter(connections, 'v') ? reference(part->unit, "x") : -1;
    part->torque = is_motor ? -1 : reference(part->unit, "torque");
    part->force_number = is_mounted && has_letter(connections, 's') ? c->force_count++ : -1;
    c->state_count += part->unit->memory_count;
    return at;
}

static int read_count(const Count *count, const char *at, size_t *number, Text *why)
{
    int value = 0;
    const int wrong = !token_count(count, at, 0, &value, why);
    *number = (size_t)value;
    return wrong;
}

/* Read an entry; where the next begins, or NULL with the reason.  `starts`: start values of the
   coupling's variables. */
static const char *read_entry(Unit *unit, const char *at, const char **starts)
{
    Composite *c = unit->own;
    char words[REASON_SIZE];
    Text why = text_in(words, sizeof words);
    int wrong = 0;
    const char *value;
    if ((value = text_after(at, "part="))) {
        return read_part(unit, c->parts + c->part_count++, value);
    }
    if ((value = text_after(at, "corners="))) {
        wrong = read_count(&CORNERS, value, &c->corner_count, &why);
    } else if ((value = text_after(at, "changes="))) {
        wrong = read_count(&CHANGES, value, &c->change_count, &why);
    } else {
        *starts = text_after(at, "own=");
        wrong = !*starts;
    }
    if (wrong) {
        refuse_composition(unit, why.length ? words : "it has an entry this library does not know");
    }
    return wrong ? NULL : token_next(at);
}

/* -- layout ---------------------------------------------------------------------------------- */

/* Take over variables of a unit, those of a part under its name. */
static size_t copy_variables(Unit *unit, size_t at, const Unit *part, const Layout *layout,
                   const double *starts, size_t first, size_t count)
{
    size_t k;
    for (k = 0; k < count; k++) {
        unit->layout.reals[at + k] = layout->reals[first + k];
        unit->layout.reals[at + k].owner = part ? part->name : NULL;
        unit->starts[at + k] = starts[first + k];
    }
    return at + count;
}

/* Parameters of all parts and the coupling's, its inputs, outputs of all parts and its own. */
static void lay_out_variables(Unit *unit, const Layout *coupling, const double *starts)
{
    Composite *c = unit->own;
    Layout *layout = &unit->layout;
    size_t at = 0;
    int k;
    for (k = 0; k < c->part_count; k++) {
        const Unit *part = c->parts[k].unit;
        c->parts[k].first = at;
        at = copy_variables(unit, at, part, &part->layout, part->starts, 0, part->layout.parameters.count);
    }
    c->tolerance = at;
    c->top_speed = at + 1;
    c->limit = at + 2;
    c->rise = c->motor ? 0 : at + 3;
    c->changes = at + 4 + 2 * c->corner_count;
    at = copy_variables(unit, at, NULL, coupling, starts, 0, coupling->parameters.count);
    layout->parameters.count = layout->inputs.first = c->speed_input = at;
    c->outer = at + (c->motor ? 0 : 2);
    at = copy_variables(unit, at, NULL, coupling, starts, coupling->inputs.first,
                        coupling->inputs.count);
    layout->inputs.count = coupling->inputs.count;
    layout->computed.first = layout->observed.first = at;
    for (k = 0; k < c->part_count; k++) {
        const Unit *part = c->parts[k].unit;
        const size_t first = part->layout.computed.first;
        c->parts[k].observed = at;
        at = copy_variables(unit, at, part, &part->layout, part->starts, first,
                  part->layout.real_count - first);
    }
    c->results = at;
    at = copy_variables(unit, at, NULL, coupling, starts, coupling->observed.first,
                        coupling->observed.count);
    layout->observed.count = at - layout->observed.first;
    layout->real_count = at;
    layout->table = coupling->table;
    layout->sizes = coupling->sizes;
}

/* Which parts exchange force. */
static int connect(Unit *unit)
{
    Composite *c = unit->own;
    int k;
    c->members = unit_allocate(unit, (size_t)c->force_count, sizeof(int));
    if (!c->members) {
        return refuse_composition(unit, "there is not enough memory");
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        if (c->parts[k].force_number >= 0) {
            c->members[c->parts[k].force_number] = k;
        }
    }
    return 0;
}

/* Layout and start values of the whole; 1 with the reason. */
static int describe(Unit *unit, const char *coupling_starts)
{
    const Composite *c = unit->own;
    const Table *table = table_of("Composite", c->motor ? "motor" : "", "");
    Sizes sizes = {1, 1, 1, 1, 0, 2, 0, 2, 0, 0, 0, 0, 0, 0, 0};
    Layout coupling;
    Variable *reals;
    double *starts;
    size_t count, total;
    int k;
    sizes.planes = c->parts->unit->layout.sizes.planes;
    sizes.points = (int)c->corner_count;
    sizes.unbalances = (int)c->change_count;
    count = total = layout_count(table, &sizes, MOST_REALS);
    for (k = 0; k < c->part_count; k++) {
        const Layout *layout = &c->parts[k].unit->layout;
        total += layout->real_count - layout->inputs.count;
    }
    if (total > MOST_REALS) {
        return refuse_composition(unit, "it has more variables than a unit may");
    }
    reals = unit_allocate(unit, count, sizeof *reals);
    starts = unit_allocate(unit, count, sizeof *starts);
    unit->layout.reals = unit_allocate(unit, total, sizeof *reals);
    unit->starts = unit_allocate(unit, total, sizeof(double));
    if (!reals || !starts || !unit->layout.reals || !unit->starts) {
        return refuse_composition(unit, "there is not enough memory");
    }
    coupling = layout_in(reals, table, &sizes);
    layout_starts(&coupling, starts);
    if (token_starts(coupling_starts, starts, coupling.computed.first)) {
        return refuse_composition(unit, "it has start values of variables that are not its own");
    }
    lay_out_variables(unit, &coupling, starts);
    return 0;
}

int composite_build(Unit *unit, const char *token)
{
    const char *at, *coupling_starts = NULL;
    Text identity = text_in(unit->token, sizeof unit->token);
    Composite *c;
    size_t count = 0;
    for (at = token; *at; at = token_next(at)) {
        count += text_after(at, "part=") != NULL;
    }
    unit->equations = &COMPOSITE_EQUATIONS;
    unit->own = c = unit_allocate(unit, 1, sizeof *c);
    if (!c || !count || count > MOST_UNITS || !(c->parts = unit_allocate(unit, count, sizeof *c->parts))) {
        return refuse_composition(unit, "it has no parts, or too many for the memory");
    }
    for (at = token_next(token); at && *at;) {
        at = read_entry(unit, at, &coupling_starts);
    }
    if (!at) {
        return 1;
    }
    if (!coupling_starts || !c->part_count) {
        return refuse_composition(unit, "it ends too early");
    }
    if (c->motor && (c->corner_count || c->change_count)) {
        return refuse_composition(unit, "with a motor it has neither corners nor changes");
    }
    if (connect(unit) || describe(unit, coupling_starts)) {
        return 1;
    }
    token_identity(token, &identity);
    unit->memory_count = composite_memory(c, NULL);
    return 0;
}
