program bezel_abaqus
  !! bezel_abaqus FOLDER JOB: writes JOB_mesh.inp, the part of an input file that follows from JOB.bezel: nodes, user elements,
  !! sets. Dots in names of sets become underlines; a set of sides becomes the set of the nodes whose functions live there.
  use, intrinsic :: iso_fortran_env, only: error_unit
  use abaqus_job, only: job_type, read_job, interface_kind
  use abaqus_elements, only: point_words
  use extraction_mesh, only: set_of_nodes, set_of_elements
  use surface_facets, only: facet_surface, build_surface_facets
  implicit none (type, external)
  type(job_type), target :: job
  character(:), allocatable :: fault
  character(1000) :: folder, name
  integer :: code, i, n, unit
  integer, allocatable :: types(:)

  call get_command_argument(1, folder)
  call get_command_argument(2, name)
  if (name == '') then
    write (error_unit, '(a)') 'bezel_abaqus FOLDER JOB: writes FOLDER/JOB_mesh.inp from FOLDER/JOB.bezel and its mesh'
    stop 2, quiet=.true.
  end if
  call read_job(trim(folder), trim(name), job, fault)
  if (allocated(fault)) then
    write (error_unit, '(a)') fault
    stop 2, quiet=.true.
  end if
  open (newunit=unit, file=trim(folder)//'/'//trim(name)//'_mesh.inp', action='write', iostat=code)
  if (code /= 0) then
    write (error_unit, '(a)') trim(folder)//': the folder cannot be written to'
    stop 3, quiet=.true.
  end if

  write (unit, '(a)') '** Written by bezel_abaqus from '//trim(name)//'.bezel', '*NODE'
  do i = 1, job%mesh%nn
    write (unit, '(i0,3(:,", ",es23.16))') i, job%mesh%x(1:job%ndm, i)
  end do
  allocate (types(0))
  do i = 1, size(job%places)
    n = 1000*job%places(i)%kind + size(job%places(i)%nodes)
    if (.not. any(types == n)) types = [types, n]
  end do
  do i = 1, size(types)
    call write_type(types(i))
  end do
  do i = 1, size(job%mesh%sets)
    if (job%mesh%sets(i)%kind == set_of_nodes) then
      call write_list('*NSET, NSET='//label(job%mesh%sets(i)%name), job%mesh%sets(i)%items)
    else if (job%mesh%sets(i)%kind == set_of_elements) then
      if (job%first > 0) call write_list('*ELSET, ELSET='//label(job%mesh%sets(i)%name), &
                                         job%mesh%sets(i)%items + job%first - 1)
    else
      call write_side_nodes(i)
    end if
  end do
  close (unit)

contains

  subroutine write_type(type_number)
    !! All elements of a kind and number of nodes.
    integer, intent(in) :: type_number
    integer :: i, kind, nodes, first, variables

    kind = type_number/1000
    nodes = mod(type_number, 1000)
    variables = 1
    do i = 1, size(job%interfaces)
      if (kind == interface_kind) variables = max(variables, point_words*job%interfaces(i)%gp**(job%ndm - 1))
    end do
    write (unit, '(a,i0,a,i0,a,i0,a,i0,a,i0)') '*USER ELEMENT, TYPE=U', type_number, ', NODES=', nodes, ', COORDINATES=', &
      job%ndm, ', PROPERTIES=', merge(4, 5, kind == interface_kind), ', VARIABLES=', variables
    write (unit, '(a)') merge('1, 2   ', '1, 2, 3', job%ndm == 2)
    first = -1
    do i = 1, size(job%places)
      if (job%places(i)%kind /= kind .or. size(job%places(i)%nodes) /= nodes) cycle
      if (job%places(i)%of /= first) then
        first = job%places(i)%of
        if (kind /= interface_kind) write (unit, '(a,i0,a)') '*ELEMENT, TYPE=U', type_number, ', ELSET=BEZEL_BULK'
        if (kind == interface_kind) write (unit, '(a,i0,a,i0)') '*ELEMENT, TYPE=U', type_number, ', ELSET=BEZEL_INTERFACE_', first
      end if
      call write_list('', [number_of(i), job%places(i)%nodes])
    end do
  end subroutine write_type

  integer function number_of(place)
    integer, intent(in) :: place

    if (job%places(place)%kind /= interface_kind) then
      number_of = job%first + place - 1
    else
      number_of = job%interfaces(job%places(place)%of)%first + place - job%range(job%places(place)%of) - 1
    end if
  end function number_of

  subroutine write_side_nodes(set)
    integer, intent(in) :: set
    type(facet_surface), target :: surface
    logical :: on(job%mesh%nn)
    integer, pointer, contiguous :: nodes(:)
    integer :: f, a

    call build_surface_facets(job%mesh%elements, job%mesh%sets(set)%items, job%mesh%sets(set)%sides, surface)
    on = .false.
    do f = 1, surface%set%ne
      nodes => surface%set%connectivity(f)
      on(nodes) = .true.
    end do
    call write_list('*NSET, NSET='//label(job%mesh%sets(set)%name), pack([(a, a=1, job%mesh%nn)], on))
  end subroutine write_side_nodes

  subroutine write_list(head, items)
    !! Ten numbers a line; a line that goes on ends with a comma.
    character(*), intent(in) :: head
    integer, intent(in) :: items(:)
    integer :: k

    if (len(head) > 0) write (unit, '(a)') head
    do k = 1, size(items), 10
      write (unit, '(*(i0,:,", "))', advance='no') items(k:min(k + 9, size(items)))
      write (unit, '(a)') merge(',', ' ', k + 9 < size(items))
    end do
  end subroutine write_list

  function label(name) result(text)
    character(*), intent(in) :: name
    character(:), allocatable :: text
    integer :: i

    text = name
    do i = 1, len(text)
      if (text(i:i) == '.') text(i:i) = '_'
    end do
  end function label
end program bezel_abaqus
