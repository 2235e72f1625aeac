/* The recurrence of weights' series, put in place for one weight (weights_series.c) and for two side by side
   (lanes/two_weights.h).  There stands what it is made of, which is undefined
   again at the end:

   WEIGHTS(name)   a function of this text; Weights: what it is about, with the members of SeriesWeight
   Numbers         one of each weight; NUMBERS(x): all are x
   Vectors         a pair of each weight; VECTORS(name): what base/pair.h has of a pair; OF_TRACK(pair): each is that */

/* Im(a p*) is the sum of both numbers of (-i a) p, and of a (i p).  Two sums of a kind: one waits for the last one's end.
   What is known last is added last: all that follows waits for it. */
IN_LINE void WEIGHTS(advance)(Weights *weight, int k, const Pair *pull, Pair known, Numbers speed, Number carried)
{
    const Vectors *unit = weight->unit + k, *rate = weight->rate;
    Vectors even = VECTORS(zero)(), odd = even, across = even;
    Vectors along = VECTORS(times)(OF_TRACK(pair_turned_back(known)), weight->unit[0]);
    int j;
    for (j = 1; j < k; j += 2) {
        odd = VECTORS(add_by_both)(odd, unit[1 - j], rate[j]);
        even = VECTORS(add_by_both)(even, unit[-j], rate[j + 1]);
        along = VECTORS(add_times)(along, OF_TRACK(pull[j - 1]), unit[1 - j]);
        across = VECTORS(add_times)(across, OF_TRACK(pull[j]), unit[-j]);
    }
    if (j == k) {
        odd = VECTORS(add_by_both)(odd, unit[1 - k], rate[k]);
        along = VECTORS(add_times)(along, OF_TRACK(pull[k - 1]), unit[1 - k]);
    }
    along = VECTORS(sum)(along, across);
    weight->turned = VECTORS(add_by_both)(VECTORS(scaled)(VECTORS(sum)(even, odd), NUMBERS(k + 1)), unit[1],
                                          VECTORS(scaled)(rate[0], NUMBERS(k + 1)));
    weight->free = -weight->lever * ((VECTORS(x)(along) + VECTORS(y)(along)) - weight->roll * carried) -
                   weight->damping_rate * speed;
}

IN_LINE Vectors WEIGHTS(force)(const Weights *weight)
{
    const Vectors moved = VECTORS(add_scaled)(weight->turned, weight->unit[0], weight->free);
    return VECTORS(scaled)(VECTORS(turned_back)(moved), weight->moment);
}

IN_LINE Numbers WEIGHTS(pulled)(const Weights *weight, Pair acceleration)
{
    const Vectors along = VECTORS(times)(OF_TRACK(acceleration), VECTORS(turned)(weight->along));
    return VECTORS(x)(along) + VECTORS(y)(along);
}

IN_LINE void WEIGHTS(finish)(Weights *weight, int k, Numbers acceleration, const double *per)
{
    const Vectors turned = VECTORS(turned)(weight->turned), turned_unit = VECTORS(turned)(weight->unit[0]);
    weight->rate[k + 1] = VECTORS(both)(acceleration * per[0]);
    weight->unit[k + 2] = VECTORS(scaled)(VECTORS(add_scaled)(turned, turned_unit, acceleration), NUMBERS(per[0] * per[1]));
}
#undef WEIGHTS
#undef Weights
#undef Numbers
#undef NUMBERS
#undef Vectors
#undef VECTORS
#undef OF_TRACK
