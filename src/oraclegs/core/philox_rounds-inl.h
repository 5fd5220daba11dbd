// The rounds of Philox4x32-10 [Salmon 2011]. Without a guard: included once into each namespace whose number types need
// it (core/rng.h for plain numbers, core/simd/uint_lanes-inl.h for vectors), after MultiplyWide of that type.

/// Replaces the counter x[0 .. 3] by random bits. U is uint32_t or a vector of them, with ^, a constructor from
/// uint32_t and MultiplyWide(a, b, high, low), which gives both halves of the 64-bit product of a and the uint32_t b.
template <class U>
ORACLEGS_HD inline void PhiloxRounds(uint64_t seed, U* x) {
  uint32_t k0 = static_cast<uint32_t>(seed), k1 = static_cast<uint32_t>(seed >> 32);
  for (int round = 0; round < 10; ++round) {
    U high0, low0, high1, low1;
    MultiplyWide(x[0], 0xD2511F53u, &high0, &low0);
    MultiplyWide(x[2], 0xCD9E8D57u, &high1, &low1);
    x[0] = high1 ^ x[1] ^ U(k0);
    x[1] = low1;
    x[2] = high0 ^ x[3] ^ U(k1);
    x[3] = low0;
    k0 += 0x9E3779B9u;
    k1 += 0xBB67AE85u;
  }
}
