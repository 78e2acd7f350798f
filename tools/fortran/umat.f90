! SPDX-License-Identifier: GPL-3.0-or-later
!> UMAT with the calling convention of Abaqus/Standard (CalculiX and others take it too).
!>
!> Material NAME is read once from NAME.json, the result of perihom under that name in lower
!> case, in the folder of the environment variable PERIHOM_RESULTS (default: where the job
!> runs). *DEPVAR needs 6 (1 + terms) numbers, 3 (1 + terms) for a plane stress result;
!> with a damage law 7 and 4.
!>   ntens 6: solids; 4: plane strain, generalised plane strain and axisymmetry (11 22 33 12),
!>   with a tensor of six components; 3: plane stress, with the tensor of a plane stress result.
!> The axes are those of the material's *ORIENTATION, small strain and rotation.
module perihom_umat
    use, intrinsic :: iso_c_binding
    use perihom
    implicit none
    private
    public :: find_material, stop_with

    integer, parameter :: most = 256
    character(len=80), save :: names(most)
    type(perihom_material), save :: materials(most)
    integer, save :: count = 0

contains

    subroutine stop_with(text)
        character(len=*), intent(in) :: text
        write (*, '(2a)') 'perihom UMAT: ', text
        stop 1
    end subroutine

    function lower(text) result(small)
        character(len=*), intent(in) :: text
        character(len=len(text)) :: small
        integer :: i
        small = text
        do i = 1, len(text)
            if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') small(i:i) = achar(iachar(text(i:i)) + 32)
        end do
    end function

    !> The material called `name`; read when it is asked for first, by one thread.
    subroutine find_material(name, material)
        character(len=*), intent(in) :: name
        type(perihom_material), intent(out) :: material
        character(len=1024) :: folder
        integer :: i, status, length
        !$omp critical (perihom_materials)
        do i = 1, count
            if (names(i) == name) exit
        end do
        if (i > count) then
            if (count == most) call stop_with('more than 256 materials')
            call get_environment_variable('PERIHOM_RESULTS', folder, length)
            if (length == 0) folder = '.'
            call perihom_load(trim(folder)//'/'//trim(lower(name))//'.json', materials(i), status)
            if (status /= 0) call stop_with(perihom_message())
            names(i) = name
            count = i
        end if
        material = materials(i)
        !$omp end critical (perihom_materials)
    end subroutine
end module

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, &
                temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, &
                celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, kinc)
    use, intrinsic :: iso_c_binding
    use perihom
    use perihom_umat
    implicit none
    character(len=80) :: cmname
    integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
    real(c_double) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), &
                      drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), &
                      dpred(1), props(nprops), coords(3), drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
    ! Component i of Abaqus (11 22 33 12 13 23; plane stress 11 22 12) is component at(i) here.
    integer, parameter :: solid(6) = [1, 2, 3, 6, 5, 4], sheet(3) = [1, 2, 3]
    type(perihom_material) :: material
    real(c_double) :: de(6), s(6), t(6, 6), work(ntens)
    integer :: n, status, at(ntens)

    call find_material(cmname, material)
    n = perihom_components(material)
    if (n == 6 .and. ndi == 3) then
        at = solid(1:ntens)
    else if (n == 3 .and. ntens == 3) then
        at = sheet
    else
        call stop_with('the elements and the result do not go together: plane stress elements need a result of '// &
                       'plane: stress, all others one of 3D or generalised plane strain')
    end if
    if (nstatv < perihom_state_size(material)) call stop_with('*DEPVAR is too small for '//trim(cmname))
    de = 0
    de(at) = dstran
    work = stress
    call perihom_update(material, statev, de(1:n), dtime, s(1:n), t(1:n, 1:n), status)
    if (status /= 0) then
        pnewdt = 0.25_c_double ! a smaller step, as the solver would try after a failure
        return
    end if
    stress = s(at)
    ddsdde = t(at, at)
    sse = sse + 0.5_c_double * dot_product(work + stress, dstran) ! stored and dissipated together
end subroutine
