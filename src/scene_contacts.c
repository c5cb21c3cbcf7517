#include "scene_contacts.h"

void scene_read_contacts(struct config_reader *reader, config_setting_t *top, int samples,
                         struct scene *scene) {
    static const char *const known[] = {
        "collision_rate",   "interaction_rate", "threshold",  "viscosity",
        "interpenetration", "collision",        "reciprocal", NULL};
    struct interaction_settings *interaction = &scene->interaction;
    config_setting_t *group = config_group(reader, top, "contacts");
    config_known(reader, group, known);
    scene->collision_rate = config_number(reader, group, "collision_rate", POSITIVE, 300);
    interaction->rate = config_number(reader, group, "interaction_rate", POSITIVE, 90);
    interaction->threshold = config_number(reader, group, "threshold", NOT_NEGATIVE, 0.9);
    interaction->viscosity = config_number(reader, group, "viscosity", NOT_NEGATIVE, 5);
    interaction->interpenetration = config_switch(reader, group, "interpenetration", group != NULL);
    interaction->collision = config_switch(reader, group, "collision", group != NULL);
    interaction->reciprocal = config_switch(reader, group, "reciprocal", true);
    if (interaction->threshold > 1)
        config_fail(reader, config_setting_get_member(group, "threshold"),
                    "threshold: %g is not between 0 and 1", interaction->threshold);
    if (samples == 0 && (interaction->interpenetration || interaction->collision))
        config_fail(reader, group,
                    "contacts: wisps touch with their envelopes, and these have none; add "
                    "envelope = { }; or set interpenetration and collision to false");
}
