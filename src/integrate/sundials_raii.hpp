#pragma once
// Owners of SUNDIALS objects. Destroy them before the Context they were made in.

#include <arkode/arkode_erkstep.h>
#include <cvodes/cvodes.h>
#include <idas/idas.h>
#include <memory>
#include <new>
#include <nvector/nvector_serial.h>
#include <span>
#include <stdexcept>
#include <string>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nonlinearsolver.h>
#include <type_traits>
#include <utility>

namespace rodwake::integrate::sundials {

/// Calls `release(object)` on destruction.
template<auto release>
struct Deleter {
    template<class T>
    void operator()(T* object) const {
        release(object);
    }
};

inline void free_context(SUNContext context) { SUNContext_Free(&context); }
inline void free_cvode(void* memory) { CVodeFree(&memory); }
inline void free_ida(void* memory) { IDAFree(&memory); }
inline void free_erkstep(void* memory) { ERKStepFree(&memory); }

template<class Handle, auto release>
using Owner = std::unique_ptr<std::remove_pointer_t<Handle>, Deleter<release>>;

using Context = Owner<SUNContext, free_context>;
using Vector = Owner<N_Vector, N_VDestroy>;
using Matrix = Owner<SUNMatrix, SUNMatDestroy>;
using LinearSolver = Owner<SUNLinearSolver, SUNLinSolFree>;
using NonlinearSolver = Owner<SUNNonlinearSolver, SUNNonlinSolFree>;
using ButcherTable = Owner<ARKodeButcherTable, ARKodeButcherTable_Free>;

/// Frees an array of `size` vectors.
struct VectorArrayDeleter {
    int size = 0;
    void operator()(N_Vector* vectors) const { N_VDestroyVectorArray(vectors, size); }
};
using VectorArray = std::unique_ptr<N_Vector, VectorArrayDeleter>;

using CvodeMemory = Owner<void*, free_cvode>;
using IdaMemory = Owner<void*, free_ida>;
using ErkMemory = Owner<void*, free_erkstep>;

/// SUNDIALS constructors return null only when memory ran out.
template<class Pointer>
Pointer made(Pointer object) {
    if (!object)
        throw std::bad_alloc();
    return object;
}

/// For set-up calls, which fail only on arguments that check_problem has already excluded, or for lack of
/// memory.
inline void require(int flag) {
    if (flag < 0)
        throw std::logic_error("SUNDIALS set-up call failed with flag " + std::to_string(flag));
}

inline Context make_context() {
    SUNContext context = nullptr;
    if (SUNContext_Create(nullptr, &context) != 0)
        throw std::bad_alloc();
    return Context(context);
}

inline Vector make_vector(std::size_t size, SUNContext context) {
    Vector vector(made(N_VNew_Serial(static_cast<sunindextype>(size), context)));
    N_VEnableFusedOps_Serial(vector.get(),
                             SUNTRUE); // one pass for a sum of stages: short states pay per call
    return vector;
}

inline std::span<double> elements(N_Vector vector) {
    return {NV_DATA_S(vector), static_cast<std::size_t>(NV_LENGTH_S(vector))};
}

} // namespace rodwake::integrate::sundials
