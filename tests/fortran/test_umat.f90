! SPDX-License-Identifier: GPL-3.0-or-later
!> Drives the UMAT through load cycles and compares with the exact solution. Prints TAP.
!> The material: C(t) = C_inf + C_1 exp(-t / 2) + C_2 exp(-t / 30), written by umat.sh.
!>
!> Under eps(t) = eps0 sin(w t) from rest the exact stress of a term of time tau is
!>   C w / (w^2 + 1/tau^2) [ w sin(w t) + cos(w t) / tau - exp(-t / tau) / tau ] . eps0
program test_umat
    use, intrinsic :: iso_c_binding
    use perihom
    implicit none
    integer, parameter :: steps = 2000
    real(c_double), parameter :: w = 0.7_c_double, tau(2) = [2, 30], amplitude(6) = [1d-3, -4d-4, 7d-4, 9d-4, -1.3d-3, 5d-4]
    integer :: number = 0, failed = 0

    call cycles(6)
    call cycles(4)
    call tangent_is_consistent()
    call damage()
    call errors()
    print '(a, i0)', '1..', number
    if (failed > 0) stop 1

contains

    subroutine check(good, what)
        logical, intent(in) :: good
        character(len=*), intent(in) :: what
        number = number + 1
        if (.not. good) failed = failed + 1
        print '(a, i0, 2a)', trim(merge('ok    ', 'not ok', good))//' ', number, ' - ', what
    end subroutine

    !> Isotropic tensor lambda, mu in the order of Abaqus.
    function iso(bulk, shear) result(c)
        real(c_double), intent(in) :: bulk, shear
        real(c_double) :: c(6, 6)
        integer :: i
        c = 0
        c(1:3, 1:3) = bulk - 2 * shear / 3
        do i = 1, 3
            c(i, i) = c(i, i) + 2 * shear
            c(i + 3, i + 3) = shear
        end do
    end function

    subroutine call_umat(stress, state, tangent, strain, increment, t, dt, which)
        character(len=*), intent(in), optional :: which
        real(c_double) :: stress(:), state(:), tangent(:, :), strain(:), increment(:), t, dt
        real(c_double) :: sse, spd, scd, rpl, ddsddt(6), drplde(6), drpldt, props(1), coords(3), drot(3, 3), pnewdt, &
                          celent, f0(3, 3), f1(3, 3), predef(1), dpred(1), time(2)
        integer :: jstep(4)
        character(len=80) :: name
        external :: umat
        name = 'RESIN'
        if (present(which)) name = which
        time = t
        sse = 0
        pnewdt = 1
        call umat(stress, state, tangent, sse, spd, scd, rpl, ddsddt, drplde, drpldt, strain, increment, time, dt, &
                  0d0, 0d0, predef, dpred, name, 3, size(stress) - 3, size(stress), size(state), props, 0, coords, &
                  drot, pnewdt, celent, f0, f1, 1, 1, 1, 1, jstep, 1)
    end subroutine

    function exact(t) result(s)
        real(c_double), intent(in) :: t
        real(c_double) :: s(6), c(6, 6, 0:2)
        integer :: k
        c(:, :, 0) = iso(2d0, 0.5d0)
        c(:, :, 1) = iso(1d0, 0.4d0)
        c(:, :, 2) = iso(1d0, 0.6d0)
        s = matmul(c(:, :, 0), amplitude) * sin(w * t)
        do k = 1, 2
            s = s + matmul(c(:, :, k), amplitude) * w / (w**2 + tau(k)**(-2)) &
                * (w * sin(w * t) + cos(w * t) / tau(k) - exp(-t / tau(k)) / tau(k))
        end do
    end function

    !> Five cycles. The increments are straight, the sine is not: a chord is off by (w dt)^2 / 8 of
    !> the amplitude, 3.1e-5 with 400 steps a cycle.
    subroutine cycles(n)
        integer, intent(in) :: n
        real(c_double) :: stress(n), state(18), tangent(n, n), strain(n), increment(n), dt, t, worst, largest, want(6), a(6)
        integer :: k
        character(len=40) :: what
        state = 0
        stress = 0
        worst = 0
        largest = 0
        a = amplitude
        dt = 5 * 8 * atan(1d0) / w / steps
        do k = 1, steps
            t = (k - 1) * dt
            strain = a(1:n) * sin(w * t)
            increment = a(1:n) * sin(w * (t + dt)) - strain
            call call_umat(stress, state, tangent, strain, increment, t, dt)
            want = exact(t + dt)
            if (n == 6) worst = max(worst, maxval(abs(stress - want)))
            if (n == 4) worst = max(worst, maxval(abs(stress - want(1:4))))
            largest = max(largest, maxval(abs(want)))
        end do
        write (what, '(a, i0, a, es8.1)') 'cycles, ntens ', n, ': off by ', worst / largest
        call check(worst < (w * dt)**2 / 8 * largest, trim(what))
    end subroutine

    subroutine tangent_is_consistent()
        real(c_double) :: s(6), s0(6), state(18), copy(18), t(6, 6), junk(6, 6), zero(6), step(6)
        integer :: j
        real(c_double) :: worst
        state = [(1d-3 * j, j=1, 18)]
        zero = 0
        worst = 0
        s0 = 0
        copy = state
        call call_umat(s0, copy, t, zero, zero, 0d0, 1.5d0)
        do j = 1, 6
            step = 0
            step(j) = 1d-3
            copy = state
            s = 0
            call call_umat(s, copy, junk, zero, step, 0d0, 1.5d0)
            worst = max(worst, maxval(abs((s - s0) / 1d-3 - t(:, j))))
        end do
        call check(worst < 1d-7, 'the tangent is the derivative')
        call check(maxval(abs(t - transpose(t))) < 1d-14, 'the tangent is symmetric')
    end subroutine

    !> Axis 3 is the third of Abaqus too; 12 is the fourth here and the sixth there. C(d) of brittle.json
    !> is (1 - d) times isotropic K 4, G 2, the load of a strain along 3 is its size.
    subroutine damage()
        real(c_double) :: s(6), state(7), t(6, 6), zero(6), step(6)
        real(c_double), parameter :: C33 = 4 + 8d0 / 3
        zero = 0
        step = 0
        state = 0
        s = 0
        step(3) = 1.5d-3
        call call_umat(s, state, t, zero, step, 0d0, 1d0, 'BRITTLE')
        call check(abs(state(7) - 0.25d0) < 1d-12 .and. abs(s(3) - 0.75d0 * C33 * 1.5d-3) < 1d-15, 'damage on its way')
        ! d s33 / d e33 = (1 - d) C33 - C33 e33 0.5 / 1e-3
        call check(abs(t(3, 3) - C33 * (0.75d0 - 1.5d-3 * 0.5d0 / 1d-3)) < 1d-10, 'the tangent softens')
        step = 0
        step(4) = 1d-4
        call call_umat(s, state, t, zero, step, 0d0, 1d0, 'BRITTLE')
        call check(abs(s(4) - 2d0 * (1 - state(7)) * 1d-4) < 1d-15, 'shear 12 of Abaqus')
        step = 0
        step(3) = -1.5d-3
        step(4) = -1d-4
        call call_umat(s, state, t, zero, step, 0d0, 1d0, 'BRITTLE')
        call check(maxval(abs(s)) < 1d-15 .and. state(7) > 0.25d0, 'back to nothing, damage stays')
    end subroutine

    subroutine errors()
        type(perihom_material) :: m
        real(c_double) :: state(18), s(6), t(6, 6), zero(6)
        integer :: status, n, states
        zero = 0
        call perihom_load('nowhere.json', m, status)
        call check(status /= 0 .and. index(perihom_message(), 'nowhere.json') > 0, 'a file that is not there')
        call perihom_update(m, state, zero, 1d0, s, t, status)
        call check(status /= 0 .and. index(perihom_message(), 'not loaded') > 0, 'a material that is not loaded')
        call perihom_load('resin.json', m, status)
        n = perihom_components(m)
        states = perihom_state_size(m)
        call check(status == 0 .and. n == 6 .and. states == 18, 'sizes')
        state = 0
        s = 0
        call perihom_update(m, state(1:6), zero, 1d0, s, t, status)
        call check(status /= 0 .and. index(perihom_message(), '18') > 0, 'an array that is too short')
        call perihom_update(m, state, zero, -1d0, s, t, status)
        call check(status /= 0, 'a negative time step')
        call perihom_stiffness(m, t, status)
        call check(status == 0 .and. abs(t(4, 4) - 1.5d0) < 1d-14, 'instantaneous stiffness')
        call perihom_free(m)
        call perihom_free(m)
        call check(perihom_components(m) == 0, 'freed twice')
    end subroutine
end program
