! SPDX-License-Identifier: GPL-3.0-or-later
!> The effective material of a perihom result in Fortran: read it once, update any number of
!> integration points. Components: Voigt 11 22 33 23 13 12 with engineering shear, or 11 22 12.
!> Every call has an integer status, 0 where it went well, else `perihom_message` says why.
module perihom
    use, intrinsic :: iso_c_binding
    implicit none
    private
    public :: perihom_material, perihom_load, perihom_free, perihom_components, perihom_state_size
    public :: perihom_update, perihom_message, perihom_stiffness

    !> A material; copies share it. Thread-safe: it never changes after perihom_load.
    type :: perihom_material
        private
        type(c_ptr) :: point = c_null_ptr
        type(c_ptr) :: effective = c_null_ptr
    end type

    ! ph_error, of which only its size and the message matter here
    type, bind(c) :: c_error
        integer(c_int) :: status = 0
        type(c_ptr) :: file = c_null_ptr
        integer(c_int) :: line = 0, iteration = 0
        real(c_double) :: residual = 0
        character(kind=c_char) :: msg(512) = c_null_char, key(80) = c_null_char
    end type

    interface
        integer(c_int) function ph_effective_read(path, out, err) bind(c)
            import :: c_int, c_char, c_ptr, c_error
            character(kind=c_char), intent(in) :: path(*)
            type(c_ptr), intent(out) :: out
            type(c_error), intent(inout) :: err
        end function
        subroutine ph_effective_free(effective) bind(c)
            import :: c_ptr
            type(c_ptr), intent(inout) :: effective
        end subroutine
        integer(c_int) function ph_point_material_new(effective, out, err) bind(c)
            import :: c_int, c_ptr, c_error
            type(c_ptr), value :: effective
            type(c_ptr), intent(out) :: out
            type(c_error), intent(inout) :: err
        end function
        subroutine ph_point_material_free(material) bind(c)
            import :: c_ptr
            type(c_ptr), intent(inout) :: material
        end subroutine
        integer(c_int) function ph_point_components(material) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: material
        end function
        integer(c_size_t) function ph_point_state_size(material) bind(c)
            import :: c_size_t, c_ptr
            type(c_ptr), value :: material
        end function
        integer(c_int) function ph_point_update(material, state, dstrain, dt, stress, tangent) bind(c)
            import :: c_int, c_ptr, c_double
            type(c_ptr), value :: material
            real(c_double), intent(inout) :: state(*)
            real(c_double), intent(in) :: dstrain(*)
            real(c_double), value :: dt
            real(c_double), intent(out) :: stress(*), tangent(*)
        end function
    end interface

    character(len=512), save :: last_message = ''
    !$omp threadprivate(last_message)

contains

    !> Read a result.json, or the folder that holds one.
    subroutine perihom_load(path, material, status)
        character(len=*), intent(in) :: path
        type(perihom_material), intent(out) :: material
        integer, intent(out) :: status
        type(c_error) :: err
        integer :: i
        status = ph_effective_read(c_text(path), material%effective, err)
        if (status == 0) status = ph_point_material_new(material%effective, material%point, err)
        if (status == 0) return
        last_message = ''
        do i = 1, 512
            if (err%msg(i) == c_null_char) exit
            last_message(i:i) = err%msg(i)
        end do
        call perihom_free(material)
    end subroutine

    subroutine perihom_free(material)
        type(perihom_material), intent(inout) :: material
        call ph_point_material_free(material%point)
        call ph_effective_free(material%effective)
    end subroutine

    !> Why the last call of this thread failed.
    function perihom_message() result(text)
        character(len=:), allocatable :: text
        text = trim(last_message)
    end function

    !> Components of strain and stress, 6 or 3; 0: not loaded.
    integer function perihom_components(material) result(n)
        type(perihom_material), intent(in) :: material
        n = 0
        if (c_associated(material%point)) n = ph_point_components(material%point)
    end function

    !> Numbers of state that a point needs; all zero is the virgin state.
    integer function perihom_state_size(material) result(n)
        type(perihom_material), intent(in) :: material
        n = 0
        if (c_associated(material%point)) n = int(ph_point_state_size(material%point))
    end function

    !> One increment: strain grows linearly over dt >= 0 (0: a jump).
    !> state(perihom_state_size), dstrain and stress(n), tangent(n, n), symmetric.
    subroutine perihom_update(material, state, dstrain, dt, stress, tangent, status)
        type(perihom_material), intent(in) :: material
        real(c_double), intent(inout) :: state(:)
        real(c_double), intent(in) :: dstrain(:), dt
        real(c_double), intent(out) :: stress(:), tangent(:, :)
        integer, intent(out) :: status
        integer :: n
        n = perihom_components(material)
        status = 3
        if (n == 0) then
            last_message = 'the material is not loaded'
        else if (size(state) < perihom_state_size(material) .or. size(dstrain) < n .or. size(stress) < n &
                 .or. any(shape(tangent) /= n)) then
            write (last_message, '(a, i0, a, i0)') 'arrays are too short: ', perihom_state_size(material), &
                ' numbers of state, components ', n
        else
            status = ph_point_update(material%point, state, dstrain, dt, stress, tangent)
            if (status /= 0) last_message = 'the strain increment or the time step is not admissible'
        end if
    end subroutine

    !> Stiffness of an instantaneous strain.
    subroutine perihom_stiffness(material, stiffness, status)
        type(perihom_material), intent(in) :: material
        real(c_double), intent(out) :: stiffness(:, :)
        integer, intent(out) :: status
        real(c_double), allocatable :: state(:), zero(:), stress(:)
        integer :: n
        n = perihom_components(material)
        allocate (state(perihom_state_size(material)), zero(n), stress(n))
        state = 0
        zero = 0
        call perihom_update(material, state, zero, 0.0_c_double, stress, stiffness, status)
    end subroutine

    function c_text(text) result(array)
        character(len=*), intent(in) :: text
        character(kind=c_char) :: array(len_trim(text) + 1)
        integer :: i
        do i = 1, len_trim(text)
            array(i) = text(i:i)
        end do
        array(len_trim(text) + 1) = c_null_char
    end function
end module
